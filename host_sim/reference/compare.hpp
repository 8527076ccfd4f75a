// How far two poses of the same frame are apart, in units of what both claim to know.
#pragma once

#include <array>

#include "host_sim/reference/rigid.hpp"

namespace berth::host {

/// A pose with its six sigmas: rotation about the camera's axes (rad), translation (mm).
struct PoseWithSigmas {
  Rigid camera_from_target;
  std::array<double, 6> sigmas{};
};

struct PoseDifference {
  std::array<double, 6> deltas{};           ///< log(R_a R_b^T) in rad, t_a - t_b in mm
  std::array<double, 6> combined_sigmas{};  ///< each delta over sqrt(sigma_a^2 + sigma_b^2)
  double largest = 0;                       ///< of the six
};

/// Differences of a from b. Two sigmas of zero make any difference infinite.
PoseDifference compare_poses(const PoseWithSigmas& a, const PoseWithSigmas& b);

}  // namespace berth::host
