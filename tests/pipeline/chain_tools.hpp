// Frames through the whole chain, for tests: images in, FrameResult out, errors against truth.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <memory>
#include <vector>

#include "host_sim/io/camera_file.hpp"
#include "host_sim/io/target_file.hpp"
#include "host_sim/parameters/build_block.hpp"
#include "host_sim/render/render.hpp"
#include "host_sim/render/sample_scene.hpp"
#include "pipeline/pipeline.hpp"

namespace berth::test {

inline ImageView view_of(const host::Image8& image) {
  ImageView view;
  view.pixels = image.data.data();
  view.width = view.stride = image.width;
  view.height = image.height;
  return view;
}

inline FrameResult process(const host::Image8& image, const Parameters& parameters,
                           const Prior& prior = {}) {
  static const auto workspace = std::make_unique<Workspace>();
  FrameResult result;
  process_frame(parameters, view_of(image), prior, *workspace, result);
  return result;
}

inline FrameResult process(const host::Image8& image, const host::Camera& camera,
                           const host::Target& target) {
  return process(image, host::make_parameters(camera, target).value());
}

inline FrameResult process(const host::Image8& image) {
  return process(image, host::default_camera(), host::default_target());
}

/// An image of HEC-1's size from a function of the pixel, clipped to 0..255.
template <typename Level>
host::Image8 painted(Level level) {
  host::Image8 image{1024, 1024, std::vector<std::uint8_t>(1024 * 1024)};
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const double value = std::min(255.0, std::max(0.0, static_cast<double>(level(x, y))));
      image.data[static_cast<std::size_t>(y * image.width + x)] =
          static_cast<std::uint8_t>(std::lround(value));
    }
  }
  return image;
}

struct PoseErrors {
  double rotation_deg, translation_mm;
};

inline PoseErrors errors_of(const RigidTransform& pose, const host::Pose& truth) {
  Eigen::Matrix3d R;
  Eigen::Vector3d t;
  for (int i = 0; i < 9; ++i) R(i / 3, i % 3) = std::ldexp(pose.rotation(i / 3, i % 3).raw(), -30);
  for (int i = 0; i < 3; ++i) t[i] = std::ldexp(pose.translation_mm[i].raw(), -18);
  const Eigen::Quaterniond q(R * truth.R.transpose());
  return {2 * std::atan2(q.vec().norm(), std::abs(q.w())) * 180 / M_PI, (t - truth.t).norm()};
}

/// Turned by roll about the sight, tilted about the image's x axis, a little off the axis.
inline host::Pose pose_at(double distance_mm, double tilt_deg, double roll_deg) {
  const auto turn = [](double deg, const Eigen::Vector3d& axis) {
    return Eigen::AngleAxisd(deg * M_PI / 180, axis).toRotationMatrix();
  };
  host::Pose pose;
  pose.R = turn(roll_deg, Eigen::Vector3d::UnitZ()) * turn(tilt_deg, Eigen::Vector3d::UnitX());
  pose.t = Eigen::Vector3d(0.02, -0.03, 1) * distance_mm;
  return pose;
}

/// A target seen before at this pose, its blur unknown.
inline Prior prior_of(const host::Pose& pose) {
  Prior prior;
  prior.has_pose = true;
  for (int i = 0; i < 9; ++i) {
    prior.camera_from_target.rotation(i / 3, i % 3) = Unit::from_raw(
        static_cast<std::int32_t>(std::lround(std::ldexp(pose.R(i / 3, i % 3), 30))));
  }
  for (int i = 0; i < 3; ++i) {
    prior.camera_from_target.translation_mm[i] =
        Mm::from_raw(static_cast<std::int32_t>(std::lround(std::ldexp(pose.t[i], 18))));
  }
  return prior;
}

}  // namespace berth::test
