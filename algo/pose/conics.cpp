#include "pose/conics.hpp"

#include <utility>

namespace berth {
namespace {

constexpr int kRootSteps = 24;  // 5 from the power-of-two bound, 5 quadratic, the rest for triples
constexpr int kDoubleRootBits = 7;  // roots up to 5 deg from the real axis; 0.05 px makes 1 deg

Conic adjugate(const Conic& c) {
  return {c.xx * c.yy - c.xy * c.xy, c.xy * c.sy - c.sx * c.yy, c.sx * c.xy - c.xx * c.sy,
          c.ss * c.yy - c.sy * c.sy, c.sx * c.sy - c.ss * c.xy, c.ss * c.xx - c.sx * c.sx};
}

/// Trace of the product of two symmetric matrices.
Scaled trace_of_product(const Conic& a, const Conic& b) {
  return a.ss * b.ss + a.xx * b.xx + a.yy * b.yy +
         (a.sx * b.sx + a.sy * b.sy + a.xy * b.xy).times_power_of_two(1);
}

Scaled determinant(const Conic& c, const Conic& adj) {
  return c.ss * adj.ss + c.sx * adj.sx + c.sy * adj.sy;
}

Scaled largest_entry(const Conic& c) {
  Scaled largest = abs(c.ss);
  for (const Scaled* entry : {&c.sx, &c.sy, &c.xx, &c.xy, &c.yy}) {
    if (largest < abs(*entry)) largest = abs(*entry);
  }
  return largest;
}

Conic normalized(const Conic& c) {
  const Scaled largest = largest_entry(c);
  if (largest.is_zero()) return c;
  const int n = -largest.log2();
  return {c.ss.times_power_of_two(n), c.sx.times_power_of_two(n), c.sy.times_power_of_two(n),
          c.xx.times_power_of_two(n), c.xy.times_power_of_two(n), c.yy.times_power_of_two(n)};
}

/// det(A + g B) = c3 g^3 + c2 g^2 + c1 g + c0
struct Cubic {
  Scaled c3, c2, c1, c0;
};

[[gnu::noinline]] Cubic pencil_cubic(const Conic& a, const Conic& b) {
  const Conic adj_a = adjugate(a), adj_b = adjugate(b);
  return {determinant(b, adj_b), trace_of_product(adj_b, a), trace_of_product(adj_a, b),
          determinant(a, adj_a)};
}

/// Root of t^3 + p t + q farthest from 0. Newton from a power of two beyond Fujiwara's bound
/// 2 max(|p|^(1/2), |q / 2|^(1/3)), from where it falls monotonically on that root.
Scaled outermost_root(const Scaled& p, const Scaled& q) {
  if (p.is_zero() && q.is_zero()) return Scaled();
  constexpr int kNone = -(1 << 20);
  const int by_p = p.is_zero() ? kNone : (p.log2() + 2) >> 1;
  const int by_q = q.is_zero() ? kNone : q.log2() >= 0 ? q.log2() / 3 + 1 : -(-q.log2() / 3) + 1;
  const Scaled bound = Scaled(1).times_power_of_two((by_p > by_q ? by_p : by_q) + 1);
  Scaled t = q.is_negative() ? bound : -bound;
  for (int step = 0; step < kRootSteps; ++step) {
    const Scaled t2 = t * t;
    const Scaled slope = t2.times_power_of_two(1) + t2 + p;
    if (slope.is_zero()) break;
    const Scaled delta = (t * (t2 + p) + q) / slope;
    if (delta.is_zero() || delta.log2() < t.log2() - 60) break;
    t -= delta;
    if (t.is_zero()) break;
  }
  return t;
}

/// The simple real root of a cubic that is farthest from its inflection. c3 is not zero.
[[gnu::noinline]] Scaled isolated_root(const Cubic& f) {
  const Scaled inverse = Scaled(1) / f.c3;
  const Scaled b = f.c2 * inverse, c = f.c1 * inverse, d = f.c0 * inverse;
  const Scaled h = b / Scaled(3);
  const Scaled p = c - b * h;
  const Scaled q = h * (h * h).times_power_of_two(1) - h * c + d;
  const Scaled g = outermost_root(p, q) - h;
  // The shift by h may have cost digits: one step on the polynomial itself.
  const Scaled slope = (g.times_power_of_two(1) + g + b.times_power_of_two(1)) * g + c;
  if (slope.is_zero()) return g;
  return g - (((g + b) * g + c) * g + d) / slope;
}

struct LinePair {
  bool is_real = false;
  ConicPoint first, second;
};

/// C + [p]x with p the lines' common point is 2 l m^T: its largest entry's row and column.
[[gnu::noinline]] LinePair split(const Conic& c) {
  LinePair pair;
  const Conic adj = adjugate(c);  // -p p^T
  const ConicPoint columns[3] = {
      {adj.ss, adj.sx, adj.sy}, {adj.sx, adj.xx, adj.xy}, {adj.sy, adj.xy, adj.yy}};
  const Scaled diagonal[3] = {adj.ss, adj.xx, adj.yy};
  int pivot = 0;
  for (int i = 1; i < 3; ++i) {
    if (abs(diagonal[pivot]) < abs(diagonal[i])) pivot = i;
  }
  ConicPoint p;  // stays zero where both lines coincide
  const Scaled size = largest_entry(c);
  const bool is_double = abs(diagonal[pivot]) < (size * size).times_power_of_two(-40);
  if (!is_double) {
    if (!diagonal[pivot].is_negative()) return pair;  // complex lines
    const Scaled inverse = Scaled(1) / sqrt(-diagonal[pivot]);
    const ConicPoint& column = columns[pivot];
    p = {column.s * inverse, column.x * inverse, column.y * inverse};
  }
  const Scaled rank_one[3][3] = {{c.ss, c.sx - p.y, c.sy + p.x},
                                 {c.sx + p.y, c.xx, c.xy - p.s},
                                 {c.sy - p.x, c.xy + p.s, c.yy}};
  int row = 0, column = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (abs(rank_one[row][column]) < abs(rank_one[i][j])) {
        row = i;
        column = j;
      }
    }
  }
  pair.is_real = true;
  pair.first = {rank_one[row][0], rank_one[row][1], rank_one[row][2]};
  pair.second = {rank_one[0][column], rank_one[1][column], rank_one[2][column]};
  return pair;
}

/// Two points that span a line, eliminating the coordinate with the largest coefficient.
void span_line(const ConicPoint& l, ConicPoint& u, ConicPoint& v) {
  const Scaled zero;
  if (abs(l.s) >= abs(l.x) && abs(l.s) >= abs(l.y)) {
    u = {-l.x, l.s, zero};
    v = {-l.y, zero, l.s};
  } else if (abs(l.x) >= abs(l.y)) {
    u = {l.x, -l.s, zero};
    v = {zero, -l.y, l.x};
  } else {
    u = {l.y, zero, -l.s};
    v = {zero, l.y, -l.x};
  }
}

void add_point(const ConicPoint& u, const Scaled& a, const ConicPoint& v, const Scaled& b,
               Intersections& out) {
  if (a.is_zero() && b.is_zero()) return;
  out.point[out.count] = {u.s * a + v.s * b, u.x * a + v.x * b, u.y * a + v.y * b};
  ++out.count;
}

/// Points a u + b v of the line on the conic: A a^2 + 2 B a b + C b^2 = 0.
[[gnu::noinline]] void intersect_line(const Conic& conic, const ConicPoint& line,
                                      Intersections& out) {
  ConicPoint u, v;
  span_line(line, u, v);
  const Scaled qa = quadratic_form(conic, u, u);
  const Scaled qb = quadratic_form(conic, u, v);
  const Scaled qc = quadratic_form(conic, v, v);
  const Scaled discriminant = qb * qb - qa * qc;
  if (discriminant <= Scaled()) {
    // Against the form's norm, not its own terms: these vanish where the double root is u or v.
    const Scaled norm2 = qa * qa + (qb * qb).times_power_of_two(1) + qc * qc;
    if (discriminant < -norm2.times_power_of_two(-kDoubleRootBits)) return;
    // a : b = -B : A = C : -B, whichever pair is larger.
    abs(qa) >= abs(qc) ? add_point(u, -qb, v, qa, out) : add_point(u, qc, v, -qb, out);
    return;
  }
  const Scaled root = sqrt(discriminant);
  const Scaled w = qb.is_negative() ? root - qb : -(root + qb);
  add_point(u, w, v, qa, out);
  add_point(u, qc, v, w, out);
}

}  // namespace

Conic combine(const Conic& a, const Scaled& wa, const Conic& b, const Scaled& wb) {
  return {wa * a.ss + wb * b.ss, wa * a.sx + wb * b.sx, wa * a.sy + wb * b.sy,
          wa * a.xx + wb * b.xx, wa * a.xy + wb * b.xy, wa * a.yy + wb * b.yy};
}

Scaled quadratic_form(const Conic& c, const ConicPoint& p, const ConicPoint& q) {
  return p.s * (c.ss * q.s + c.sx * q.x + c.sy * q.y) +
         p.x * (c.sx * q.s + c.xx * q.x + c.xy * q.y) +
         p.y * (c.sy * q.s + c.xy * q.x + c.yy * q.y);
}

Intersections intersect(const Conic& first, const Conic& second) {
  Intersections out;
  const Scaled one(1);
  Conic a = normalized(first), b = normalized(second);
  Cubic cubic = pencil_cubic(a, b);
  // Where both are degenerate (a symmetric view) another pair of the same pencil is taken.
  for (int i = 0; i < 3 && cubic.c0.is_zero() && cubic.c3.is_zero(); ++i) {
    a = combine(a, one, b, i == 1 ? -one : one);
    std::swap(a, b);
    cubic = pencil_cubic(a, b);
  }
  if (abs(cubic.c3) < abs(cubic.c0)) {
    std::swap(a, b);
    cubic = {cubic.c0, cubic.c1, cubic.c2, cubic.c3};
  }
  if (cubic.c3.is_zero()) return out;
  const Scaled g = isolated_root(cubic);
  const LinePair lines = split(combine(a, one, b, g));
  if (!lines.is_real) return out;
  // The member of the pencil that is farther from the degenerate one.
  const Conic& other = abs(g) > one ? a : b;
  intersect_line(other, lines.first, out);
  intersect_line(other, lines.second, out);
  return out;
}

}  // namespace berth
