// An independent pipeline from OpenCV parts: what our poses are set beside. It shares no code and
// no method with algo/, need not be fast, and would rather give nothing than a wrong pose.
//
// Adaptive thresholds and contours; ellipses; the two poses of the ring as a circle; dots by place;
// line by grey levels; sub-pixel edges along the predicted outlines; ellipse centres of dots and
// ring and the crossing of the line's diagonals; Gauss-Newton with the centres of the projected
// conics, so that there is no perspective bias. docs/reference.md has the whole of it.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <string>

#include "host_sim/io/camera_model.hpp"
#include "host_sim/io/target_file.hpp"
#include "host_sim/reference/compare.hpp"
#include "host_sim/reference/double_twin.hpp"

namespace berth::host {

struct ReferencePose {
  bool found = false;
  Rigid camera_from_target;
  std::array<double, 6> sigmas{};  ///< rotation about the camera's axes (rad), translation (mm)
  Matrix6d covariance = Matrix6d::Zero();
  double residual_px = 0;  ///< rms per coordinate of the marker centres
  int markers = 0;         ///< centres used: dots, ring's outer and inner edge, line
  std::string why_not;     ///< where none was found
};

/// Pose of the target in an 8-bit grey image of the camera's size. Cost: 0.1 to 0.5 s for a
/// megapixel. Thread-safe.
ReferencePose reference_pose(const cv::Mat& gray, const Camera& camera, const Target& target);

}  // namespace berth::host
