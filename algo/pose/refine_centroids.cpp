// See refine_centroids.hpp.
#include "pose/refine_centroids.hpp"

#include "fixed/linear.hpp"
#include "fixed/roots.hpp"
#include "fixed/scaled.hpp"
#include "fixed/wide.hpp"
#include "pose/frames.hpp"

namespace berth {
namespace {

constexpr int kResidualFraction = 20;
constexpr int kNormalFraction = 2 * PoseJacobian::kFraction;  // of the normal matrix
constexpr int kStepFraction = 30;                             // rad, and 2^8 mm
constexpr int kMaxDamping = 10;

struct NormalEquations {
  std::int64_t matrix[6][6] = {};  // Q24
  std::int64_t gradient[6] = {};   // Q32
  std::int64_t cost = 0;           // Q36
};

/// Whitens one 2-vector; |a| <= 2^28, so both results are within 2^29 + rounding.
inline void whiten(const WeightedMarker& w, std::int32_t x, std::int32_t y,
                   std::int32_t (&out)[2]) {
  const std::int32_t p = w.is_swapped ? y : x, q = w.is_swapped ? x : y;
  out[0] = multiply_high(4 * p, w.g1.raw());
  const std::int64_t rest = std::int64_t{q - multiply_high(4 * p, w.m.raw())} * w.g2.raw();
  out[1] = static_cast<std::int32_t>(shift_round(rest, 30));
}

/// Adds one marker. |J| <= 2^29 (12 fraction bits), |e| <= 2^29 (20 bits) once whitened: with 20
/// rows every sum stays below 2^63.
void add_marker(const WeightedMarker& w, const PredictedCentroid& predicted, NormalEquations& out) {
  constexpr std::int32_t kFar = 1 << 28;  // 256 px
  std::int32_t r[2], e[2];
  for (int i = 0; i < 2; ++i) {
    const std::int64_t d =
        (std::int64_t{w.measured_px[i].raw()} - predicted.centroid_px[i].raw()) * 16;
    r[i] = d > kFar ? kFar : (d < -kFar ? -kFar : static_cast<std::int32_t>(d));
  }
  whiten(w, r[0], r[1], e);
  std::int32_t j[2][6];
  for (int k = 0; k < 6; ++k) {
    std::int32_t column[2];
    whiten(w, predicted.by_pose.row[0][k], predicted.by_pose.row[1][k], column);
    j[0][k] = column[0];
    j[1][k] = column[1];
  }
  for (int row = 0; row < 2; ++row) {
    out.cost += shift_round(std::int64_t{e[row]} * e[row], 4);
    for (int i = 0; i < 6; ++i) {
      add_product(out.gradient[i], j[row][i], e[row]);
      for (int k = 0; k <= i; ++k) add_product(out.matrix[i][k], j[row][i], j[row][k]);
    }
  }
}

bool evaluate(const Camera& camera, const TargetModel& target, const WeightedMarkers& markers,
              const RigidTransform& pose, NormalEquations& out) {
  out = NormalEquations{};
  for (int m = 0; m < markers.count; ++m) {
    const WeightedMarker& marker = markers.marker[m];
    if (!marker.used) continue;
    PredictedCentroid predicted;
    const MarkerNodes nodes = nodes_of(target, marker.kind, marker.index);
    if (!predict_centroid(camera, pose, nodes, predicted)) return false;
    add_marker(marker, predicted, out);
  }
  for (int i = 0; i < 6; ++i) {
    for (int k = i + 1; k < 6; ++k) out.matrix[i][k] = out.matrix[k][i];
  }
  return true;
}

/// Cayley's map of a rotation vector in Q30, |component| <= 2^29:
/// I + 2 / (1 + h^2) (h x + h x h x), h = delta / 2.
Mat3Unit small_rotation(const std::int64_t (&delta)[6]) {
  std::int64_t h[3], h2 = 0;
  for (int i = 0; i < 3; ++i) {
    h[i] = delta[i];  // Q31 of h = Q30 of delta
    h2 += h[i] * h[i];
  }
  h2 = shift_round(h2, 32);  // Q30, below 3/16
  const Unit s = div<30>(Unit(1), Unit::from_wide((std::int64_t{1} << 30) + h2));  // 1 / (1 + h^2)
  Mat3Unit m;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      // 2 (h h^T - h^2 I) s, and 2 s h x; delta = 2 h.
      std::int64_t entry = shift_round(h[i] * h[k], 31);  // 2 h h^T, Q30
      if (i == k) entry -= 2 * h2;
      if (i != k) entry += (k - i + 3) % 3 == 1 ? -h[3 - i - k] : h[3 - i - k];
      entry = shift_round(entry * s.raw(), 30);
      m(i, k) = Unit::from_wide(i == k ? entry + (std::int64_t{1} << 30) : entry);
    }
  }
  return m;
}

/// Solves for the step with the diagonal raised by 2^(damping - 8); 0: undamped. False when it
/// can't be solved or the step is no small motion (0.5 rad, 128 mm or so in scaled units).
[[gnu::noinline]] bool solve_step(NormalEquations& equations, int damping,
                                  std::int64_t (&step)[6]) {
  std::int64_t diagonal[6];
  for (int i = 0; i < 6; ++i) {
    std::int64_t& entry = equations.matrix[i][i];
    diagonal[i] = entry;
    if (damping > 0) entry += damping <= 8 ? shift_round(entry, 8 - damping) : entry * 2;
  }
  SpdSystem<6> system;
  const bool is_definite = system.factor(equations.matrix);
  for (int i = 0; i < 6; ++i) equations.matrix[i][i] = diagonal[i];
  if (!is_definite) return false;
  // Gradient Q32 by matrix Q24: 8 bits are there already.
  const int fraction =
      kStepFraction - (kResidualFraction + PoseJacobian::kFraction - kNormalFraction);
  if (!system.solve(equations.gradient, step, fraction)) return false;
  constexpr std::int64_t kLargest = std::int64_t{1} << 29;
  for (int i = 0; i < 3; ++i) {
    if (step[i] > kLargest || step[i] < -kLargest) return false;
    if (step[3 + i] > 8 * kLargest || step[3 + i] < -8 * kLargest) return false;
  }
  return true;
}

bool apply_step(const std::int64_t (&step)[6], const RigidTransform& pose, RigidTransform& out) {
  out.rotation = compose(small_rotation(step), pose.rotation);
  for (int i = 0; i < 3; ++i) {
    // Q30 of 2^8 mm to Q18 of 1 mm.
    const std::int64_t t = pose.translation_mm[i].raw() +
                           shift_round(step[3 + i], kStepFraction - PoseJacobian::kUnitBits - 18);
    if (t != saturate32(t)) return false;
    out.translation_mm[i] = Mm::from_wide(t);
  }
  return true;
}

/// Reduction of the cost that an undamped step promises, g . x, Q36.
std::int64_t promised_reduction(const NormalEquations& equations, const std::int64_t (&step)[6]) {
  std::int64_t reduction = 0;  // Q36
  for (int i = 0; i < 6; ++i) {
    const Scaled term =
        Scaled::from_raw(equations.gradient[i], 32) * Scaled::from_raw(step[i], kStepFraction);
    reduction += term.to_raw(36) / 8;
  }
  return reduction * 8;
}

/// What can't or need not be reduced: (sigma / 256)^2 of the unit of weight, and what the rounding
/// of the residuals, 2^-16 px, makes of the cost. A step that promises less is the last.
std::int64_t negligible_reduction(Q<24> unit_sigma, std::int64_t cost) {
  const std::int64_t sigma2 = shift_round(std::int64_t{unit_sigma.raw()} * unit_sigma.raw(), 28);
  const std::int64_t floor = sigma2 > 64 ? sigma2 : 64;  // (3e-5 px)^2
  const std::int64_t rounding = std::int64_t{isqrt(static_cast<std::uint64_t>(cost))} * 8;
  return rounding > floor ? rounding : floor;  // 2 r dr, dr = 2^-16 px
}

Q<24> larger(Q<24> a, Q<24> b) { return a < b ? b : a; }

/// Cholesky factor of a covariance, larger axis first.
struct Factor {
  bool is_swapped = false;
  Scaled l11, l22, m;
};

Factor factor_of(const Marker& marker) {
  const Q<24> xx = larger(marker.variance_xx, kMinVariance);
  const Q<24> yy = larger(marker.variance_yy, kMinVariance);
  Factor f;
  f.is_swapped = xx < yy;
  const Scaled a(f.is_swapped ? yy : xx), c(f.is_swapped ? xx : yy), b(marker.variance_xy);
  f.l11 = sqrt(a);
  if (b.is_zero()) {  // as dots have it, and one variance
    f.l22 = a == c ? f.l11 : sqrt(c);
    return f;
  }
  f.m = b / a;
  if (f.m > Scaled(1)) f.m = Scaled(1);  // no covariance: kept defined
  if (f.m < Scaled(-1)) f.m = Scaled(-1);
  const Scaled rest = c - f.m * f.m * a, floor(kMinVariance);
  f.l22 = sqrt(rest < floor ? floor : rest);
  return f;
}

}  // namespace

void weigh_markers(const MarkerSet& markers, WeightedMarkers& out) {
  out = WeightedMarkers{};
  Scaled smallest(Px::max());
  Factor factors[kMaxMarkers];
  for (int i = 0; i < markers.count; ++i) {
    const Marker& marker = markers.markers[i];
    if (!marker.located) continue;
    Factor& f = factors[out.count];
    f = factor_of(marker);
    if (f.l22 < smallest) smallest = f.l22;
    if (f.l11 < smallest) smallest = f.l11;
    WeightedMarker& w = out.marker[out.count++];
    w.kind = marker.kind;
    w.index = marker.index;
    w.source = static_cast<std::uint8_t>(i);
    w.is_swapped = f.is_swapped;
    w.measured_px = marker.center_px;
    w.m = f.m.to<30>();
  }
  for (int m = 0; m < out.count; ++m) {
    out.marker[m].g1 = (smallest / factors[m].l11).to<30>();
    out.marker[m].g2 =
        factors[m].l22 == factors[m].l11 ? out.marker[m].g1 : (smallest / factors[m].l22).to<30>();
  }
  out.used = out.count;
  out.unit_sigma_px = smallest.to<24>();
}

Refined refine_centroids(const Camera& camera, const TargetModel& target,
                         const WeightedMarkers& markers, const RigidTransform& start,
                         std::int32_t most_iterations) {
  Refined result;
  result.camera_from_target = start;
  result.freedom = 2 * markers.used - 6;
  NormalEquations now;
  if (markers.used < 3 || !evaluate(camera, target, markers, start, now)) return result;
  int damping = 0;
  while (result.iterations < most_iterations && damping <= kMaxDamping) {
    ++result.iterations;
    std::int64_t step[6];
    RigidTransform moved;
    if (!solve_step(now, damping, step) || !apply_step(step, result.camera_from_target, moved)) {
      damping += 3;
      continue;
    }
    const std::int64_t reduction = promised_reduction(now, step);
    if (damping == 0 && reduction <= negligible_reduction(markers.unit_sigma_px, now.cost)) {
      result.camera_from_target = moved;
      now.cost = now.cost > reduction ? now.cost - reduction : 0;
      result.is_determined = true;
      break;
    }
    NormalEquations next;
    if (!evaluate(camera, target, markers, moved, next) || next.cost > now.cost) {
      damping += 3;
      continue;
    }
    result.camera_from_target = moved;
    now = next;
    damping = damping > 3 ? damping - 3 : 0;
  }
  result.camera_from_target.rotation = orthonormalize(result.camera_from_target.rotation);
  result.cost = now.cost;
  result.ok = true;
  return result;
}

bool centroid_covariance(const Camera& camera, const TargetModel& target,
                         const WeightedMarkers& markers, const RigidTransform& pose,
                         PoseCovariance& out) {
  NormalEquations equations;
  if (!evaluate(camera, target, markers, pose, equations)) return false;
  SpdSystem<6> system;
  if (!system.factor(equations.matrix)) return false;
  system.invert();
  const Scaled unit_sigma(markers.unit_sigma_px);
  for (int i = 0; i < 3; ++i) {
    const Scaled rotation = Scaled::from_raw(system.sigma(i, kNormalFraction, 30), 30);
    const Scaled translation = Scaled::from_raw(system.sigma(3 + i, kNormalFraction, 30), 30);
    out.sigma_rotation[i] = (rotation * unit_sigma).to<28>();
    out.sigma_translation_mm[i] =
        (translation * unit_sigma).times_power_of_two(PoseJacobian::kUnitBits).to<18>();
  }
  int next = 0;
  for (int i = 0; i < 6; ++i) {
    for (int k = i + 1; k < 6; ++k) out.correlation[next++] = system.correlation(i, k);
  }
  return true;
}

Q<16> whitened_residual(const WeightedMarkers& markers, const Refined& refined) {
  if (refined.freedom <= 0) return Q<16>(0);
  const Scaled cost = Scaled::from_raw(refined.cost, 36) / Scaled(refined.freedom);
  return (sqrt(cost) / Scaled(markers.unit_sigma_px)).to<16>();
}

Px residual_px(const WeightedMarkers& markers, const Refined& refined) {
  Scaled trace;  // of V^-1 in units of the smallest variance
  for (int i = 0; i < markers.count; ++i) {
    const WeightedMarker& w = markers.marker[i];
    if (!w.used) continue;
    const Scaled g1(w.g1), g2(w.g2), m(w.m);
    trace += g1 * g1 + g2 * g2 * (Scaled(1) + m * m);
  }
  if (trace.is_zero()) return Px(0);
  return sqrt(Scaled::from_raw(refined.cost, 36) / trace).to<16>();
}

}  // namespace berth
