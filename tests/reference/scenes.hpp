// Rendered frames with truth for the tests of the reference.
#pragma once

#include <cmath>
#include <opencv2/core.hpp>

#include "host_sim/io/camera_file.hpp"
#include "host_sim/io/target_file.hpp"
#include "host_sim/reference/reference.hpp"
#include "host_sim/render/render.hpp"
#include "host_sim/render/sample_scene.hpp"

namespace berth::test {

inline cv::Mat frame_of(const host::Scene& scene, const host::Camera& camera,
                        const host::Target& target) {
  const host::Image8 image = host::render_frame(scene, camera, target);
  return cv::Mat(image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.data.data()))
      .clone();
}

/// Errors of a pose against the truth, as the target's specification counts them.
struct Errors {
  double rotation_deg, translation_mm, distance_mm;
  double largest_sigmas;  ///< of the six axes

  bool is_high_precision() const {
    const double scale = std::pow(distance_mm / 300, 2);
    return rotation_deg <= 0.015 * scale && translation_mm <= 0.2 * scale;
  }
  bool is_false() const { return rotation_deg > 2 || translation_mm > 0.02 * distance_mm; }
};

inline Errors errors_of(const host::ReferencePose& pose, const host::Pose& truth) {
  const auto d = host::compare_poses({pose.camera_from_target, pose.sigmas},
                                     {{truth.R, truth.t}, std::array<double, 6>{}});
  const Eigen::Vector3d rotation(d.deltas[0], d.deltas[1], d.deltas[2]);
  const Eigen::Vector3d translation(d.deltas[3], d.deltas[4], d.deltas[5]);
  return {rotation.norm() * 180 / CV_PI, translation.norm(), truth.t.norm(), d.largest};
}

/// Target turned by roll, then tilted about the image's x axis, at the specification's test place.
inline host::Pose pose_at(double distance_mm, double tilt_deg, double roll_deg) {
  host::Pose pose;
  pose.R = host::rotation_exp({0, 0, roll_deg * CV_PI / 180}) *
           host::rotation_exp({tilt_deg * CV_PI / 180, 0, 0});
  pose.t = Eigen::Vector3d(0.02, -0.03, 1) * distance_mm;
  return pose;
}

}  // namespace berth::test
