#include "host_sim/reference/marker_model.hpp"

#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace berth::host {
namespace {

// Chords leave 1 - (2/3) (pi/n)^2 of a disc's area, the same in every direction of the ellipse: the
// centroid's error is of third order in the distortion across the disc, below 1e-6 px.
constexpr int kOutlinePoints = 128;

Eigen::Vector3d vector_of(const std::array<double, 3>& a) { return {a[0], a[1], a[2]}; }

AreaCentroid outline_centroid(const Camera& camera, const Rigid& pose,
                              const std::vector<cv::Point3d>& outline) {
  return polygon_centroid(project_points(camera, pose, outline));
}

}  // namespace

cv::Mat1d camera_matrix(const Camera& c) {
  return (cv::Mat1d(3, 3) << c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1);
}

cv::Mat1d distortion_row(const Camera& c) {
  return (cv::Mat1d(1, 5) << c.k1, c.k2, c.p1, c.p2, c.k3);
}

std::vector<cv::Point2d> project_points(const Camera& camera, const Rigid& pose,
                                        const std::vector<cv::Point3d>& points_mm) {
  const Eigen::Vector3d r = rotation_log(pose.R);
  const cv::Vec3d rotation(r.x(), r.y(), r.z());
  const cv::Vec3d translation(pose.t.x(), pose.t.y(), pose.t.z());
  std::vector<cv::Point2d> pixels;
  cv::projectPoints(points_mm, rotation, translation, camera_matrix(camera), distortion_row(camera),
                    pixels);
  return pixels;
}

std::vector<cv::Point2d> ideal_points(const Camera& camera,
                                      const std::vector<cv::Point2d>& pixels) {
  std::vector<cv::Point2d> ideal;
  if (pixels.empty()) return ideal;
  const cv::Mat1d k = camera_matrix(camera);
  const cv::TermCriteria fine(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 50, 1e-10);
  cv::undistortPoints(pixels, ideal, k, distortion_row(camera), cv::noArray(), k, fine);
  return ideal;
}

Eigen::Vector2d project_ideal(const Camera& camera, const Rigid& pose,
                              const Eigen::Vector3d& point_mm) {
  const Eigen::Vector3d p = pose.R * point_mm + pose.t;
  return {camera.fx * p.x() / p.z() + camera.cx, camera.fy * p.y() / p.z() + camera.cy};
}

std::vector<cv::Point3d> circle_outline(const Eigen::Vector3d& center_mm, double radius_mm,
                                        int points) {
  std::vector<cv::Point3d> outline;
  for (int i = 0; i < points; ++i) {
    const double angle = 2 * CV_PI * i / points;
    outline.emplace_back(center_mm.x() + radius_mm * std::cos(angle),
                         center_mm.y() + radius_mm * std::sin(angle), center_mm.z());
  }
  return outline;
}

std::vector<cv::Point3d> bar_outline(const Line& line, int points_per_side) {
  const double angle = line.angle_deg * CV_PI / 180;
  const Eigen::Vector2d along(std::cos(angle), std::sin(angle));
  const Eigen::Vector2d across(-along.y(), along.x());
  const Eigen::Vector2d center(line.center[0], line.center[1]);
  const auto corner = [&](int i) {
    const double u = (i % 4 == 0 || i % 4 == 3) ? -0.5 : 0.5;
    const double v = i % 4 < 2 ? -0.5 : 0.5;
    return Eigen::Vector2d(center + u * line.length * along + v * line.width * across);
  };
  std::vector<cv::Point3d> outline;
  for (int side = 0; side < 4; ++side) {
    for (int i = 0; i < points_per_side; ++i) {
      const double step = static_cast<double>(i) / points_per_side;
      const Eigen::Vector2d p = (1 - step) * corner(side) + step * corner(side + 1);
      outline.emplace_back(p.x(), p.y(), 0);
    }
  }
  return outline;
}

Eigen::Vector2d conic_center(const Camera& camera, const Rigid& pose, const Circle& circle) {
  Eigen::Matrix3d H;
  H.col(0) = pose.R.col(0) * circle.radius_mm;
  H.col(1) = pose.R.col(1) * circle.radius_mm;
  H.col(2) = pose.R * circle.center_mm + pose.t;
  const Eigen::Matrix3d dual = H * Eigen::Vector3d(1, 1, -1).asDiagonal() * H.transpose();
  return {camera.fx * dual(0, 2) / dual(2, 2) + camera.cx,
          camera.fy * dual(1, 2) / dual(2, 2) + camera.cy};
}

AreaCentroid polygon_centroid(const std::vector<cv::Point2d>& polygon) {
  // Green's theorem relative to the first point, which keeps the small differences.
  const cv::Point2d origin = polygon.front();
  double area = 0;
  double x = 0;
  double y = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const cv::Point2d a = polygon[i] - origin;
    const cv::Point2d b = polygon[(i + 1) % polygon.size()] - origin;
    const double cross = a.x * b.y - b.x * a.y;
    area += cross / 2;
    x += cross * (a.x + b.x) / 6;
    y += cross * (a.y + b.y) / 6;
  }
  return {{origin.x + x / area, origin.y + y / area}, area};
}

Eigen::Vector2d dot_centroid(const Camera& camera, const Rigid& pose, const Dot& dot) {
  const auto outline = circle_outline(vector_of(dot.center), dot.radius, kOutlinePoints);
  return outline_centroid(camera, pose, outline).center;
}

Eigen::Vector2d ring_centroid(const Camera& camera, const Rigid& pose, const Ring& ring) {
  const Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  const AreaCentroid outer =
      outline_centroid(camera, pose, circle_outline(origin, ring.outer, kOutlinePoints));
  const AreaCentroid inner =
      outline_centroid(camera, pose, circle_outline(origin, ring.inner, kOutlinePoints));
  return (outer.center * outer.area - inner.center * inner.area) / (outer.area - inner.area);
}

Eigen::Vector2d line_centroid(const Camera& camera, const Rigid& pose, const Line& line) {
  return outline_centroid(camera, pose, bar_outline(line, kOutlinePoints / 4)).center;
}

}  // namespace berth::host
