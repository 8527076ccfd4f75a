// Do the grey levels look like the target in this pose? Each marker against the black beside it.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "host_sim/io/camera_model.hpp"
#include "host_sim/io/target_file.hpp"
#include "host_sim/reference/rigid.hpp"

namespace berth::host {

/// Shares of the sampled places that stand out of their surroundings, 0..1.
struct LayoutScore {
  double contrast_dn = 0;  ///< median over the ring
  double ring = 0;
  double line = 0;
  std::vector<double> dots;

  /// Ring, half a line and all dots but one, or three, are there.
  bool is_target() const;
  double total() const;
};

/// `smooth` is 8 bit with bright markers, smoothed to below 2 DN of noise.
LayoutScore score_layout(const cv::Mat& smooth, const Camera& camera, const Target& target,
                         const Rigid& camera_from_target);

}  // namespace berth::host
