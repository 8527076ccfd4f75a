#include "host_sim/render/payload_plane.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/render/det_math.hpp"
#include "host_sim/render/outline.hpp"

namespace berth::host {

Eigen::Vector3d PayloadPlane::camera_point(double x_mm, double y_mm) const {
  return camera_from_target(pose_, {x_mm, y_mm, depth_mm_});
}

Eigen::Vector2d PayloadPlane::pixel_of(double x_mm, double y_mm) const {
  const Eigen::Vector3d p = camera_point(x_mm, y_mm);
  return {camera_.fx * p.x() / p.z() + camera_.cx, camera_.fy * p.y() / p.z() + camera_.cy};
}

Place PayloadPlane::place_of(double x_mm, double y_mm) const {
  return {x_mm, y_mm, std::max(1.0, camera_point(x_mm, y_mm).z()) / camera_.fx};
}

// Intersects the pixel's ray s (x, y, 1) with the plane: in the target frame its z is depth.
Place PayloadPlane::place_at(double u_px, double v_px) const {
  const double x = (u_px - camera_.cx) / camera_.fx;
  const double y = (v_px - camera_.cy) / camera_.fy;
  const Eigen::Matrix3d& R = pose_.R;
  const Eigen::Vector3d& t = pose_.t;
  const auto to_target = [&R](int axis, double a, double b, double c) {
    return R(0, axis) * a + R(1, axis) * b + R(2, axis) * c;
  };
  const double slope = std::max(0.05, to_target(2, x, y, 1.0));  // grazing rays: a far place
  const double s = (depth_mm_ + to_target(2, t.x(), t.y(), t.z())) / slope;
  return place_of(to_target(0, s * x - t.x(), s * y - t.y(), s - t.z()),
                  to_target(1, s * x - t.x(), s * y - t.y(), s - t.z()));
}

Place PayloadPlane::random_place(Random& random, double border_px) const {
  const double u = random.uniform(-border_px, camera_.width + border_px);
  const double v = random.uniform(-border_px, camera_.height + border_px);
  return place_at(u, v);
}

Polygon PayloadPlane::polygon(const std::vector<std::array<double, 2>>& corners_mm) const {
  const double nearest_mm = 0.1 * pose_.t.z();
  Polygon outline;
  outline.reserve(corners_mm.size());
  for (const auto& [x, y] : corners_mm) {
    if (camera_point(x, y).z() < nearest_mm) return {};
    outline.push_back(pixel_of(x, y));
  }
  return outline;
}

Polygon PayloadPlane::circle(const Place& place, double radius_mm) const {
  const double radius_px = radius_mm / place.mm_per_px;
  const int vertices = std::clamp(static_cast<int>(8.0 + 6.0 * std::sqrt(radius_px)), 12, 160);
  std::vector<std::array<double, 2>> corners;
  for (int i = 0; i < vertices; ++i) {
    const SinCos a = det_sincos(2.0 * kPi * i / vertices);
    corners.push_back({place.x_mm + radius_mm * a.cos, place.y_mm + radius_mm * a.sin});
  }
  return polygon(corners);
}

Polygon PayloadPlane::rectangle(const Place& place, double length_mm, double width_mm,
                                double angle_rad) const {
  return polygon(rectangle_corners({place.x_mm, place.y_mm}, length_mm, width_mm, angle_rad));
}

}  // namespace berth::host
