// Projected outlines by OpenCV, as a reference that shares no code with the renderer.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <vector>

#include "host_sim/io/camera_model.hpp"
#include "host_sim/render/scene.hpp"

namespace berth::host {

struct AreaMoments {
  double area = 0;
  double x = 0;
  double y = 0;
};

/// Projects points of the target frame with cv::projectPoints.
inline std::vector<cv::Point2d> project_by_opencv(const Camera& camera, const Pose& pose,
                                                  const std::vector<cv::Point3d>& points) {
  const cv::Matx33d R(pose.R(0, 0), pose.R(0, 1), pose.R(0, 2), pose.R(1, 0), pose.R(1, 1),
                      pose.R(1, 2), pose.R(2, 0), pose.R(2, 1), pose.R(2, 2));
  cv::Vec3d rotation;
  cv::Rodrigues(R, rotation);
  const cv::Vec3d translation(pose.t.x(), pose.t.y(), pose.t.z());
  const cv::Matx33d K(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  const cv::Vec<double, 5> d(camera.k1, camera.k2, camera.p1, camera.p2, camera.k3);
  std::vector<cv::Point2d> pixels;
  cv::projectPoints(points, rotation, translation, K, d, pixels);
  return pixels;
}

inline std::vector<cv::Point3d> circle_points(double x, double y, double z, double radius) {
  constexpr int kCount = 20000;
  std::vector<cv::Point3d> points;
  for (int i = 0; i < kCount; ++i) {
    const double a = 2.0 * CV_PI * i / kCount;
    points.emplace_back(x + radius * std::cos(a), y + radius * std::sin(a), z);
  }
  return points;
}

inline std::vector<cv::Point3d> rectangle_points(double x, double y, double length, double width,
                                                 double angle_rad) {
  constexpr int kPerSide = 5000;
  const double corners[5][2] = {{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}, {-0.5, -0.5}};
  std::vector<cv::Point3d> points;
  for (int side = 0; side < 4; ++side) {
    for (int i = 0; i < kPerSide; ++i) {
      const double s = static_cast<double>(i) / kPerSide;
      const double u = length * (corners[side][0] + s * (corners[side + 1][0] - corners[side][0]));
      const double v = width * (corners[side][1] + s * (corners[side + 1][1] - corners[side][1]));
      points.emplace_back(x + u * std::cos(angle_rad) - v * std::sin(angle_rad),
                          y + u * std::sin(angle_rad) + v * std::cos(angle_rad), 0.0);
    }
  }
  return points;
}

/// Area and centroid of a polygon (Green's theorem), relative to its first vertex for precision.
inline AreaMoments polygon_moments(const std::vector<cv::Point2d>& p) {
  double area = 0, mx = 0, my = 0;
  for (size_t i = 0, j = p.size() - 1; i < p.size(); j = i++) {
    const cv::Point2d a = p[j] - p[0];
    const cv::Point2d b = p[i] - p[0];
    const double cross = a.x * b.y - b.x * a.y;
    area += 0.5 * cross;
    mx += cross * (a.x + b.x) / 6.0;
    my += cross * (a.y + b.y) / 6.0;
  }
  return {std::abs(area), p[0].x + mx / area, p[0].y + my / area};
}

/// Moments of the region between an outline and a hole.
inline AreaMoments without_hole(const AreaMoments& whole, const AreaMoments& hole) {
  const double area = whole.area - hole.area;
  return {area, (whole.area * whole.x - hole.area * hole.x) / area,
          (whole.area * whole.y - hole.area * hole.y) / area};
}

}  // namespace berth::host
