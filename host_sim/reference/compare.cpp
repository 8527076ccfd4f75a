#include "host_sim/reference/compare.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace berth::host {

PoseDifference compare_poses(const PoseWithSigmas& a, const PoseWithSigmas& b) {
  const Eigen::Vector3d rotation =
      rotation_log(a.camera_from_target.R * b.camera_from_target.R.transpose());
  const Eigen::Vector3d translation = a.camera_from_target.t - b.camera_from_target.t;
  PoseDifference difference;
  for (std::size_t i = 0; i < 6; ++i) {
    const auto axis = static_cast<Eigen::Index>(i % 3);
    const double delta = i < 3 ? rotation[axis] : translation[axis];
    const double combined = std::hypot(a.sigmas[i], b.sigmas[i]);
    difference.deltas[i] = delta;
    if (delta != 0) {
      difference.combined_sigmas[i] =
          combined > 0 ? std::abs(delta) / combined : std::numeric_limits<double>::infinity();
    }
    difference.largest = std::max(difference.largest, difference.combined_sigmas[i]);
  }
  return difference;
}

}  // namespace berth::host
