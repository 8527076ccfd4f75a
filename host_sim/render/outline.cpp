#include "host_sim/render/outline.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/render/det_math.hpp"

namespace berth::host {
namespace {

constexpr int kCircleVertices = 360;
constexpr int kSideParts = 48;

double cross(const Eigen::Vector2d& o, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return (a.x() - o.x()) * (b.y() - o.y()) - (a.y() - o.y()) * (b.x() - o.x());
}

bool are_inside_image(const Camera& camera, const Polygon& points) {
  return std::all_of(points.begin(), points.end(), [&camera](const Eigen::Vector2d& p) {
    return p.x() >= 0.0 && p.y() >= 0.0 && p.x() <= camera.width - 1.0 &&
           p.y() <= camera.height - 1.0;
  });
}

bool is_in_front(const Pose& pose, const Target& target) {
  for (const double x : {-0.5, 0.5}) {
    for (const double y : {-0.5, 0.5}) {
      const Eigen::Vector3d corner(x * target.plate_size_mm[0], y * target.plate_size_mm[1], 0.0);
      if (!(camera_from_target(pose, corner).z() > 0.0)) return false;
    }
  }
  return true;
}

}  // namespace

Eigen::Vector3d camera_from_target(const Pose& pose, const Eigen::Vector3d& p) {
  // Written out: the order of additions, and so the last bit, must not depend on the machine.
  const Eigen::Matrix3d& R = pose.R;
  return {R(0, 0) * p.x() + R(0, 1) * p.y() + R(0, 2) * p.z() + pose.t.x(),
          R(1, 0) * p.x() + R(1, 1) * p.y() + R(1, 2) * p.z() + pose.t.y(),
          R(2, 0) * p.x() + R(2, 1) * p.y() + R(2, 2) * p.z() + pose.t.z()};
}

Eigen::Vector2d project_point(const View& view, const Eigen::Vector3d& p_target_mm) {
  return project(view.camera, camera_from_target(view.pose, p_target_mm));
}

Polygon project_circle(const View& view, const Eigen::Vector3d& center_mm, double radius_mm) {
  constexpr double kStep = 2.0 * kPi / kCircleVertices;
  const double equal_area_radius = radius_mm * std::sqrt(kStep / det_sincos(kStep).sin);
  Polygon polygon;
  polygon.reserve(kCircleVertices);
  for (int i = 0; i < kCircleVertices; ++i) {
    const SinCos a = det_sincos(i * kStep);
    polygon.push_back(
        project_point(view, {center_mm.x() + equal_area_radius * a.cos,
                             center_mm.y() + equal_area_radius * a.sin, center_mm.z()}));
  }
  return polygon;
}

Polygon project_polygon(const View& view, const std::vector<std::array<double, 2>>& corners_mm,
                        double z_mm) {
  Polygon polygon;
  polygon.reserve(corners_mm.size() * kSideParts);
  for (size_t i = 0; i < corners_mm.size(); ++i) {
    const auto& a = corners_mm[i];
    const auto& b = corners_mm[(i + 1) % corners_mm.size()];
    for (int part = 0; part < kSideParts; ++part) {
      const double s = static_cast<double>(part) / kSideParts;
      polygon.push_back(
          project_point(view, {a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1]), z_mm}));
    }
  }
  return polygon;
}

std::vector<std::array<double, 2>> rectangle_corners(const std::array<double, 2>& center_mm,
                                                     double length_mm, double width_mm,
                                                     double angle_rad) {
  const SinCos a = det_sincos(angle_rad);
  std::vector<std::array<double, 2>> corners;
  for (const auto& [u, v] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
    const double x = u * length_mm;
    const double y = v * width_mm;
    corners.push_back({center_mm[0] + a.cos * x - a.sin * y, center_mm[1] + a.sin * x + a.cos * y});
  }
  return corners;
}

Polygon project_plate(const View& view, const Target& target) {
  const auto corners =
      rectangle_corners({0.0, 0.0}, target.plate_size_mm[0], target.plate_size_mm[1], 0.0);
  return project_polygon(view, corners, 0.0);
}

Polygon project_line(const View& view, const Line& line) {
  const auto corners =
      rectangle_corners(line.center, line.length, line.width, line.angle_deg * kRadPerDeg);
  return project_polygon(view, corners, 0.0);
}

Polygon project_post(const View& view, const Dot& dot) {
  const Eigen::Vector3d top(dot.center[0], dot.center[1], dot.center[2]);
  const Eigen::Vector3d foot(dot.center[0], dot.center[1], 0.0);
  Polygon points = project_circle(view, top, dot.post_radius);
  const Polygon foot_circle = project_circle(view, foot, dot.post_radius);
  points.insert(points.end(), foot_circle.begin(), foot_circle.end());
  return convex_hull(std::move(points));
}

// Andrew's monotone chain.
Polygon convex_hull(Polygon points) {
  std::sort(points.begin(), points.end(), [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  });
  Polygon hull;
  for (int pass = 0; pass < 2; ++pass) {
    const size_t start = hull.size();
    for (const Eigen::Vector2d& p : points) {
      while (hull.size() >= start + 2 && cross(hull[hull.size() - 2], hull.back(), p) <= 0.0) {
        hull.pop_back();
      }
      hull.push_back(p);
    }
    hull.pop_back();  // the next pass begins with it
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

bool is_inside_image(const View& view, const Target& target) {
  if (!is_in_front(view.pose, target)) return false;
  if (!are_inside_image(view.camera, project_plate(view, target))) return false;
  for (const Dot& dot : target.dots) {
    if (dot.center[2] == 0.0) continue;
    const Eigen::Vector3d center(dot.center[0], dot.center[1], dot.center[2]);
    if (!(camera_from_target(view.pose, center).z() > 0.0)) return false;
    const double radius = std::max(dot.radius, dot.collar_radius);
    if (!are_inside_image(view.camera, project_circle(view, center, radius))) return false;
  }
  return true;
}

}  // namespace berth::host
