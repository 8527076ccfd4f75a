// Gauss-Newton on the centroids of all markers, from a candidate pose to the least squares one.
//
//   min over (R, t) of sum_k r_k^T V_k^-1 r_k,  r_k = measured - predicted centroid
//   R <- C(delta) R,  t <- t + dt,  (J^T W J + damping) (delta, dt) = J^T W r
//
// C is Cayley's map, equal to exp up to third order. Damped (Levenberg, Marquardt) only after a
// step that did not reduce the sum. Residuals are whitened by the Cholesky factor of V_k; the unit
// of weight is the smallest standard deviation of all, so that no whitened value exceeds its pixel
// value. Ranges: docs/pose.md.
#pragma once

#include <cstdint>

#include "pose/perspective_bias.hpp"

namespace berth {

/// A measured centroid with its whitener: e1 = g1 r_p, e2 = g2 (r_q - m r_p), where p is the axis
/// with the larger variance.
struct WeightedMarker {
  MarkerKind kind = MarkerKind::kDot;
  std::uint8_t index = 0;   // which dot
  std::uint8_t source = 0;  // place in the MarkerSet
  bool used = true;
  bool is_swapped = false;  // p is y
  Vec2Px measured_px;
  Unit g1, g2, m;  // 0..1, 0..1, -1..1
};

struct WeightedMarkers {
  std::int32_t count = 0;
  std::int32_t used = 0;
  Q<24> unit_sigma_px;  // standard deviation of a whitened residual of 1 px
  WeightedMarker marker[kMaxMarkers];
};

/// Smallest accepted variance of a centroid, (0.001 px)^2: below it the model's own error counts.
constexpr Q<24> kMinVariance = Q<24>::from_raw(16);

/// All located markers with their whiteners.
void weigh_markers(const MarkerSet& markers, WeightedMarkers& out);

struct Refined {
  bool ok = false;             // a minimum was reached, with all markers in front of the camera
  bool is_determined = false;  // no direction is left open; where false it has not been asked
  RigidTransform camera_from_target;
  std::int64_t cost = 0;     // sum of squared whitened residuals, px^2, 36 fraction bits
  std::int32_t freedom = 0;  // degrees of freedom: 2 * used - 6
  std::int32_t iterations = 0;
};

constexpr int kMaxIterations = 16;

/// Needs at least three used markers. Cost: about 35 000 instructions per iteration and 5 markers,
/// 4 to 6 iterations as a rule; 3 KiB of stack.
Refined refine_centroids(const Camera& camera, const TargetModel& target,
                         const WeightedMarkers& markers, const RigidTransform& start,
                         std::int32_t most_iterations = kMaxIterations);

/// Covariance at a pose. False where the markers leave a direction undetermined.
bool centroid_covariance(const Camera& camera, const TargetModel& target,
                         const WeightedMarkers& markers, const RigidTransform& pose,
                         PoseCovariance& out);

/// Root mean square of the whitened residuals per degree of freedom: 1 as the variances predict;
/// 0 without redundancy. Saturates at 32768.
Q<16> whitened_residual(const WeightedMarkers& markers, const Refined& refined);

/// The same in pixels, over all coordinates: sqrt(sum r^T V^-1 r / sum trace(V^-1)).
Px residual_px(const WeightedMarkers& markers, const Refined& refined);

}  // namespace berth
