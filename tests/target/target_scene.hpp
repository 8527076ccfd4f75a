// Clean rendered frames at chosen poses, for the tests of stages 3 to 5.
#pragma once

#include <Eigen/Geometry>

#include "host_sim/io/default_files.hpp"
#include "host_sim/parameters/build_block.hpp"
#include "host_sim/render/render.hpp"
#include "host_sim/render/sample_scene.hpp"
#include "image/view.hpp"
#include "target/ring_pose.hpp"

namespace berth {

struct TargetScene {
  host::Camera camera = host::default_camera();
  host::Target target = host::default_target();
  Parameters parameters = *host::make_parameters(camera, target);
  host::Pose pose;
  host::Image8 frame;

  /// Tilt about an axis at `direction` in the plate, then roll; on the optical axis.
  TargetScene(double distance_mm, double tilt_deg, double roll_deg, double direction_deg = 20) {
    const double d = CV_PI_180 * direction_deg;
    const Eigen::Vector3d axis(std::cos(d), std::sin(d), 0);
    pose.R = (Eigen::AngleAxisd(CV_PI_180 * tilt_deg, axis) *
              Eigen::AngleAxisd(CV_PI_180 * roll_deg, Eigen::Vector3d::UnitZ()))
                 .toRotationMatrix();
    pose.t = Eigen::Vector3d(0.02, -0.03, 1) * distance_mm;
    frame = host::render_frame(host::clean_scene(pose), camera, target);
  }

  ImageView view() const {
    ImageView v;
    v.pixels = frame.data.data();
    v.width = frame.width;
    v.height = frame.height;
    v.stride = frame.width;
    return v;
  }

  /// The true pose in fixed point.
  RigidTransform truth() const {
    RigidTransform t;
    for (int k = 0; k < 9; ++k) {
      t.rotation(k / 3, k % 3) = Unit::saturated(
          static_cast<std::int64_t>(std::llround(pose.R(k / 3, k % 3) * (1 << 30))));
    }
    for (int k = 0; k < 3; ++k) {
      t.translation_mm[k] =
          Mm::saturated(static_cast<std::int64_t>(std::llround(pose.t[k] * (1 << 18))));
    }
    return t;
  }

  static constexpr double CV_PI_180 = 0.017453292519943295;
};

}  // namespace berth
