// See p3p.hpp; symbols, ranges and error bounds in docs/pose.md.
#include "pose/p3p.hpp"

#include "pose/conics.hpp"
#include "pose/scaled_vector.hpp"

namespace berth {
namespace {

constexpr int kNewtonSteps = 3;
constexpr int kEnoughBits = 42;  // sides right to 2^-43: far below the bearings' rounding

/// The three distance equations in (s, x, y) = (s_1, s_2 - s_1, s_3 - s_1):
///   x^2 + s (s + x) v12 = a12,  y^2 + s (s + y) v13 = a13,
///   (x - y)^2 + (s + x) (s + y) v23 = a23
struct Triangle {
  Scaled v12, v13, v23;  // squared chords |f_i - f_j|^2
  Scaled a12, a13, a23;  // squared sides, mm^2
};

struct Depths {
  Scaled s, x, y;  // mm
};

struct Residuals {
  Scaled r12, r13, r23;  // mm^2
  Scaled norm() const { return abs(r12) + abs(r13) + abs(r23); }
};

Residuals residuals_at(const Triangle& t, const Depths& d) {
  const Scaled s2 = d.s + d.x, s3 = d.s + d.y, xy = d.x - d.y;
  return {d.x * d.x + d.s * s2 * t.v12 - t.a12, d.y * d.y + d.s * s3 * t.v13 - t.a13,
          xy * xy + s2 * s3 * t.v23 - t.a23};
}

/// One Newton step by Cramer's rule; false at a singular Jacobian.
bool newton_step(const Triangle& t, const Residuals& r, Depths& d) {
  const Scaled s2 = d.s + d.x, s3 = d.s + d.y;
  const Scaled xy2 = (d.x - d.y).times_power_of_two(1);
  // Jacobian rows: [a1 b1 0], [a2 0 c2], [a3 b3 c3].
  const Scaled a1 = (d.s + s2) * t.v12, b1 = d.x.times_power_of_two(1) + d.s * t.v12;
  const Scaled a2 = (d.s + s3) * t.v13, c2 = d.y.times_power_of_two(1) + d.s * t.v13;
  const Scaled a3 = (s2 + s3) * t.v23, b3 = xy2 + s3 * t.v23, c3 = s2 * t.v23 - xy2;
  const Scaled det = -(a1 * c2 * b3) - b1 * (a2 * c3 - c2 * a3);
  if (det.is_zero()) return false;
  const Scaled inverse = Scaled(1) / det;
  const Scaled ds = -(r.r12 * c2 * b3) - b1 * (r.r13 * c3 - c2 * r.r23);
  const Scaled dx = a1 * (r.r13 * c3 - c2 * r.r23) - r.r12 * (a2 * c3 - c2 * a3);
  const Scaled dy = -(a1 * r.r13 * b3) - b1 * (a2 * r.r23 - r.r13 * a3) + r.r12 * a2 * b3;
  d = {d.s - ds * inverse, d.x - dx * inverse, d.y - dy * inverse};
  return true;
}

void polish(const Triangle& t, Depths& d) {
  Residuals r = residuals_at(t, d);
  const Scaled enough = (t.a12 + t.a13 + t.a23).times_power_of_two(-kEnoughBits);
  for (int step = 0; step < kNewtonSteps && enough < r.norm(); ++step) {
    Depths next = d;
    if (!newton_step(t, r, next)) return;
    const Residuals next_r = residuals_at(t, next);
    if (!(next_r.norm() < r.norm())) return;
    d = next;
    r = next_r;
  }
}

/// Two conics in (s 2^-k, x, y), 2^-k close to the chords, that vanish at the solutions: both are
/// differences of the equations with the right-hand sides eliminated.
struct ConicPair {
  Conic first, second, sum_of_squares;
  int k = 0;
};

[[gnu::noinline]] ConicPair conics_of(const Triangle& t) {
  ConicPair pair;
  const Scaled total = t.v12 + t.v13 + t.v23;
  pair.k = -(total.log2() / 2);
  const int k = pair.k;
  const auto ss = [k](const Scaled& v) { return v.times_power_of_two(2 * k); };
  const auto half = [k](const Scaled& v) { return v.times_power_of_two(k - 1); };
  const Scaled zero, one(1);
  const Conic m12{ss(t.v12), half(t.v12), zero, one, zero, zero};
  const Conic m13{ss(t.v13), zero, half(t.v13), zero, zero, one};
  const Conic m23{ss(t.v23), half(t.v23), half(t.v23), one, t.v23.times_power_of_two(-1) - one,
                  one};
  // By the longest side first, so that both conics have comparable sizes.
  pair.first = combine(m12, t.a23, m23, -t.a12);
  pair.second = combine(m13, t.a23, m23, -t.a13);
  pair.sum_of_squares = combine(combine(m12, one, m13, one), one, m23, one);
  return pair;
}

/// Camera coordinates of the corners, as the first and two differences.
struct Corners {
  ScaledVector first, side2, side3;
};

/// Right-handed orthonormal triad of a triangle: along side 2, in its plane, along its normal.
struct Triad {
  ScaledVector e[3];
};

Triad triad_of(const ScaledVector& side2, const ScaledVector& side3) {
  const ScaledVector e1 = unit(side2);
  const ScaledVector e3 = unit(cross(side2, side3));
  return {{e1, cross(e3, e1), e3}};
}

/// R = sum_k c_k t_k^T; t joins the centroids. False outside the range of Mm.
[[gnu::noinline]] bool align(const Corners& camera, const Corners& target, RigidTransform& out) {
  const Triad c = triad_of(camera.side2, camera.side3);
  const Triad t = triad_of(target.side2, target.side3);
  const auto row = [&](const Scaled& c1, const Scaled& c2, const Scaled& c3) {
    return c1 * t.e[0] + (c2 * t.e[1] + c3 * t.e[2]);
  };
  const ScaledVector rows[3] = {row(c.e[0].x, c.e[1].x, c.e[2].x),
                                row(c.e[0].y, c.e[1].y, c.e[2].y),
                                row(c.e[0].z, c.e[1].z, c.e[2].z)};
  const Scaled third = Scaled(1) / Scaled(3);
  const ScaledVector from = target.first + third * (target.side2 + target.side3);
  const ScaledVector to = camera.first + third * (camera.side2 + camera.side3);
  const Scaled translation[3] = {to.x - dot(rows[0], from), to.y - dot(rows[1], from),
                                 to.z - dot(rows[2], from)};
  for (int i = 0; i < 3; ++i) {
    if (abs(translation[i]) >= Scaled(Mm::max())) return false;
  }
  for (int i = 0; i < 3; ++i) {
    out.rotation(i, 0) = rows[i].x.to<30>();
    out.rotation(i, 1) = rows[i].y.to<30>();
    out.rotation(i, 2) = rows[i].z.to<30>();
    out.translation_mm[i] = translation[i].to<18>();
  }
  return true;
}

[[gnu::noinline]] bool is_degenerate(const Corners& target, const Triangle& t) {
  const Scaled min_chord = Scaled::from_raw(1, 20);
  if (t.v12 < min_chord || t.v13 < min_chord || t.v23 < min_chord) return true;
  if (t.a12.is_zero() || t.a13.is_zero() || t.a23.is_zero()) return true;
  const ScaledVector normal = cross(target.side2, target.side3);
  const Scaled area = dot(normal, normal);  // (2 area)^2 = a b sin^2 of the angle between
  const Scaled sine2(q<30>(1e-4));
  return area < sine2 * t.a12 * t.a13 || area < sine2 * t.a12 * t.a23 ||
         area < sine2 * t.a13 * t.a23;
}

/// What one call works on.
struct Problem {
  ScaledVector bearing[3];
  ScaledVector chord2, chord3;  // f_2 - f_1, f_3 - f_1
  Corners target;
  Triangle triangle;
};

[[gnu::noinline]] Problem make_problem(const PointTriple& triple) {
  Problem p;
  for (int i = 0; i < 3; ++i) p.bearing[i] = scaled_vector(triple.bearing[i]);
  p.chord2 = p.bearing[1] - p.bearing[0];
  p.chord3 = p.bearing[2] - p.bearing[0];
  p.target.first = scaled_vector(triple.point_mm[0]);
  p.target.side2 = scaled_vector(triple.point_mm[1]) - p.target.first;
  p.target.side3 = scaled_vector(triple.point_mm[2]) - p.target.first;
  const ScaledVector chord23 = p.chord3 - p.chord2, side23 = p.target.side3 - p.target.side2;
  p.triangle = {dot(p.chord2, p.chord2),
                dot(p.chord3, p.chord3),
                dot(chord23, chord23),
                dot(p.target.side2, p.target.side2),
                dot(p.target.side3, p.target.side3),
                dot(side23, side23)};
  return p;
}

/// Depths of a common point of the conics; false where a point would lie behind the camera.
[[gnu::noinline]] bool depths_of(const Triangle& t, const ConicPair& pair, ConicPoint p,
                                 Depths& d) {
  if (p.s.is_zero()) return false;
  if (p.s.is_negative()) p = {-p.s, -p.x, -p.y};
  const Scaled total = quadratic_form(pair.sum_of_squares, p, p);  // of the three squared sides
  if (total <= Scaled()) return false;
  const Scaled scale = sqrt((t.a12 + t.a13 + t.a23) / total);
  d = {(p.s * scale).times_power_of_two(pair.k), p.x * scale, p.y * scale};
  polish(t, d);
  return d.s > Scaled() && d.s + d.x > Scaled() && d.s + d.y > Scaled();
}

/// s_j f_j - s_1 f_1 = s_1 (f_j - f_1) + (s_j - s_1) f_j
[[gnu::noinline]] Corners corners_at(const Problem& p, const Depths& d) {
  return {d.s * p.bearing[0], d.s * p.chord2 + d.x * p.bearing[1],
          d.s * p.chord3 + d.y * p.bearing[2]};
}

}  // namespace

P3pResult solve_p3p(const PointTriple& triple) {
  P3pResult result;
  const Problem p = make_problem(triple);
  if (is_degenerate(p.target, p.triangle)) {
    result.reason = Reason::kDegenerate;
    return result;
  }
  const ConicPair pair = conics_of(p.triangle);
  const Intersections points = intersect(pair.first, pair.second);
  for (int i = 0; i < points.count; ++i) {
    Depths d;
    if (!depths_of(p.triangle, pair, points.point[i], d)) continue;
    const Corners camera = corners_at(p, d);
    if (align(camera, p.target, result.camera_from_target[result.count])) ++result.count;
  }
  result.reason = result.count > 0 ? Reason::kNone : Reason::kNoSolution;
  return result;
}

}  // namespace berth
