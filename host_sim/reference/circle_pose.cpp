#include "host_sim/reference/circle_pose.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <cmath>

#include "host_sim/reference/marker_model.hpp"

namespace berth::host {
namespace {

std::vector<cv::Point2d> points_on(const cv::RotatedRect& e) {
  constexpr int kPoints = 48;
  const double angle = e.angle * CV_PI / 180;
  std::vector<cv::Point2d> points;
  for (int i = 0; i < kPoints; ++i) {
    const double t = 2 * CV_PI * i / kPoints;
    const double u = e.size.width / 2.0 * std::cos(t);
    const double v = e.size.height / 2.0 * std::sin(t);
    points.emplace_back(e.center.x + u * std::cos(angle) - v * std::sin(angle),
                        e.center.y + u * std::sin(angle) + v * std::cos(angle));
  }
  return points;
}

/// The conic of ideal points as a cone in the camera frame, scaled to unit spread for the fit.
Eigen::Matrix3d fit_cone(const Camera& camera, const std::vector<cv::Point2d>& ideal) {
  cv::Point2d mean(0, 0);
  for (const cv::Point2d& p : ideal) mean += p / static_cast<double>(ideal.size());
  double spread = 0;
  for (const cv::Point2d& p : ideal)
    spread += cv::norm(p - mean) / static_cast<double>(ideal.size());
  Eigen::MatrixXd A(ideal.size(), 6);
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    const cv::Point2d p = (ideal[static_cast<std::size_t>(i)] - mean) / spread;
    A.row(i) << p.x * p.x, p.x * p.y, p.y * p.y, p.x, p.y, 1;
  }
  const Eigen::Matrix<double, 6, 1> c =
      Eigen::JacobiSVD<Eigen::MatrixXd>(A, Eigen::ComputeFullV).matrixV().col(5);
  Eigen::Matrix3d conic;
  conic << c[0], c[1] / 2, c[3] / 2, c[1] / 2, c[2], c[4] / 2, c[3] / 2, c[4] / 2, c[5];
  Eigen::Matrix3d to_unit;  // from a ray (x/z, y/z, 1) to the scaled image coordinates
  to_unit << camera.fx / spread, 0, (camera.cx - mean.x) / spread, 0, camera.fy / spread,
      (camera.cy - mean.y) / spread, 0, 0, 1;
  return to_unit.transpose() * conic * to_unit;
}

}  // namespace

std::vector<CirclePose> circle_poses(const Camera& camera, const cv::RotatedRect& ellipse,
                                     double radius_mm) {
  const Eigen::Matrix3d cone = fit_cone(camera, ideal_points(camera, points_on(ellipse)));
  // One sign of the cone has two positive eigenvalues.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(cone.determinant() < 0 ? cone
                                                                                     : -cone);
  const Eigen::Vector3d l = solver.eigenvalues().reverse();
  if (!(l[1] > 0 && l[2] < 0)) return {};
  const Eigen::Vector3d e1 = solver.eigenvectors().col(2);
  const Eigen::Vector3d e3 = solver.eigenvectors().col(0);
  const double sine = std::sqrt((l[0] - l[1]) / (l[0] - l[2]));
  const double cosine = std::sqrt((l[1] - l[2]) / (l[0] - l[2]));
  const double depth = radius_mm * l[1] / std::sqrt(-l[0] * l[2]);
  std::vector<CirclePose> poses;
  for (const double s1 : {1.0, -1.0}) {
    const Eigen::Vector3d normal = s1 * sine * e1 + cosine * e3;
    Eigen::Vector3d center = depth * (s1 * sine * l[2] / l[1] * e1 + cosine * l[0] / l[1] * e3);
    if (center.z() < 0) center = -center;
    poses.push_back({center, normal.dot(center) > 0 ? normal : Eigen::Vector3d(-normal)});
    if (sine < 1e-9) break;
  }
  return poses;
}

}  // namespace berth::host
