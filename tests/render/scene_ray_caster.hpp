// A slow, independent renderer of the target's geometry: many rays per pixel, each asking what it
// meets first. Shares no code with the renderer but the input structs.
#pragma once

#include <cmath>
#include <opencv2/calib3d.hpp>
#include <vector>

#include "host_sim/io/camera_model.hpp"
#include "host_sim/io/target_file.hpp"
#include "host_sim/render/scene.hpp"

namespace berth::host {

enum class Surface { kNothing, kGround, kMarker };

class SceneRayCaster {
 public:
  SceneRayCaster(const Pose& pose, const Target& target) : pose_(pose), target_(target) {}

  /// What the ray through normalised coordinates (x, y) meets first.
  Surface first_surface(double x, double y) const {
    const Eigen::Vector3d origin = -pose_.R.transpose() * pose_.t;
    const Eigen::Vector3d direction = pose_.R.transpose() * Eigen::Vector3d(x, y, 1.0);
    for (const Dot& dot : target_.dots) {
      if (dot.center[2] == 0.0) continue;
      const Eigen::Vector2d p = on_plane(origin, direction, dot.center[2]) -
                                Eigen::Vector2d(dot.center[0], dot.center[1]);
      if (p.norm() < dot.radius) return Surface::kMarker;
      if (p.norm() < dot.collar_radius) return Surface::kGround;
      const bool is_near = p.norm() < 10.0 * dot.radius;  // spares most rays the post
      if (is_near && meets_post(origin, direction, dot)) return Surface::kGround;
    }
    return surface_of_plate(on_plane(origin, direction, 0.0));
  }

 private:
  static Eigen::Vector2d on_plane(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                  double z) {
    return (origin + direction * ((z - origin.z()) / direction.z())).head<2>();
  }

  // Samples the post as a stack of thin discs.
  static bool meets_post(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                         const Dot& dot) {
    constexpr int kSlices = 40;
    for (int i = 0; i <= kSlices; ++i) {
      const Eigen::Vector2d p = on_plane(origin, direction, dot.center[2] * i / kSlices) -
                                Eigen::Vector2d(dot.center[0], dot.center[1]);
      if (p.norm() < dot.post_radius) return true;
    }
    return false;
  }

  Surface surface_of_plate(const Eigen::Vector2d& p) const {
    const double r = p.norm();
    if (r < target_.ring.outer && r > target_.ring.inner) return Surface::kMarker;
    for (const Dot& dot : target_.dots) {
      const Eigen::Vector2d center(dot.center[0], dot.center[1]);
      if (dot.center[2] == 0.0 && (p - center).norm() < dot.radius) return Surface::kMarker;
    }
    const Line& line = target_.line;
    const double angle = line.angle_deg * CV_PI / 180.0;
    const Eigen::Vector2d q = p - Eigen::Vector2d(line.center[0], line.center[1]);
    const double along = std::cos(angle) * q.x() + std::sin(angle) * q.y();
    const double across = std::cos(angle) * q.y() - std::sin(angle) * q.x();
    if (std::abs(along) < line.length / 2 && std::abs(across) < line.width / 2) {
      return Surface::kMarker;
    }
    const bool is_on_plate = std::abs(p.x()) < target_.plate_size_mm[0] / 2 &&
                             std::abs(p.y()) < target_.plate_size_mm[1] / 2;
    return is_on_plate ? Surface::kGround : Surface::kNothing;
  }

  const Pose& pose_;
  const Target& target_;
};

}  // namespace berth::host
