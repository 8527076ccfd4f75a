#include "host_sim/reference/double_twin.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>

#include "host_sim/reference/marker_model.hpp"

namespace berth::host {
namespace {

constexpr int kIterations = 30;

Rigid moved(const Rigid& pose, const Vector6d& step) {
  return {rotation_exp(step.head<3>()) * pose.R, pose.t + step.tail<3>()};
}

struct Linearised {
  Matrix6d information = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  double chi_squared = 0;
  double squared_px = 0;
};

Linearised linearise(const std::vector<Observation>& observations, const Rigid& pose) {
  // Central differences: steps at which rounding and curvature are both below 1e-9 of the value.
  Vector6d step;
  step << Eigen::Vector3d::Constant(1e-5), Eigen::Vector3d::Constant(1e-5 * pose.t.norm());
  Linearised sum;
  for (const Observation& o : observations) {
    const Eigen::Vector2d residual = o.center_px - o.predict(pose);
    Eigen::Matrix<double, 2, 6> J;
    for (int k = 0; k < 6; ++k) {
      const Vector6d h = Vector6d::Unit(k) * step[k];
      J.col(k) = (o.predict(moved(pose, h)) - o.predict(moved(pose, -h))) / (2 * step[k]);
    }
    const Eigen::Matrix2d weight = o.covariance_px2.inverse();
    sum.information += J.transpose() * weight * J;
    sum.gradient += J.transpose() * weight * residual;
    sum.chi_squared += residual.dot(weight * residual);
    sum.squared_px += residual.squaredNorm();
  }
  return sum;
}

/// Scales to comparable units, so that rad and mm do not spoil the conditioning.
Vector6d solve_scaled(const Linearised& system, double damping) {
  const Vector6d scale = system.information.diagonal().cwiseMax(1e-30).cwiseSqrt().cwiseInverse();
  Matrix6d scaled = scale.asDiagonal() * system.information * scale.asDiagonal();
  scaled.diagonal().array() += damping;
  return scale.asDiagonal() * scaled.ldlt().solve(scale.asDiagonal() * system.gradient);
}

}  // namespace

RefinedPose refine_pose(const std::vector<Observation>& observations, const Rigid& start) {
  RefinedPose result;
  result.camera_from_target = start;
  Linearised system = linearise(observations, start);
  double damping = 1e-6;
  for (int i = 0; i < kIterations && !result.has_converged; ++i) {
    const Vector6d step = solve_scaled(system, damping);
    if (!step.allFinite()) break;
    const Rigid next = moved(result.camera_from_target, step);
    const Linearised next_system = linearise(observations, next);
    const bool is_better =
        next.t.z() > 0 && next_system.chi_squared <= system.chi_squared * (1 + 1e-12) + 1e-18;
    damping = is_better ? damping * 0.1 : damping * 30 + 1e-6;
    const double size = step.head<3>().norm() + step.tail<3>().norm() / start.t.norm();
    result.has_converged = size < 1e-11 || (!is_better && size < 1e-8);
    if (!is_better) continue;
    result.camera_from_target = next;
    system = next_system;
  }
  result.has_converged = result.has_converged || solve_scaled(system, 0).norm() < 1e-6;
  result.covariance = system.information.inverse();
  result.chi_squared = system.chi_squared;
  result.rms_px = std::sqrt(system.squared_px / (2.0 * static_cast<double>(observations.size())));
  return result;
}

std::vector<Observation> centroid_observations(const Camera& camera, const Target& target) {
  std::vector<Observation> observations;
  const auto add = [&](std::function<Eigen::Vector2d(const Rigid&)> predict) {
    observations.push_back({Eigen::Vector2d::Zero(), Eigen::Matrix2d::Identity(), predict});
  };
  for (const Dot& dot : target.dots) {
    add([camera, dot](const Rigid& pose) { return dot_centroid(camera, pose, dot); });
  }
  add([camera, ring = target.ring](const Rigid& pose) {
    return ring_centroid(camera, pose, ring);
  });
  add([camera, line = target.line](const Rigid& pose) {
    return line_centroid(camera, pose, line);
  });
  return observations;
}

std::vector<Rigid> solve_p3p(const std::vector<Eigen::Vector3d>& points_mm,
                             const std::vector<Eigen::Vector2d>& rays) {
  std::vector<cv::Point3d> object;
  std::vector<cv::Point2d> image;
  for (int i = 0; i < 3; ++i) {
    object.emplace_back(points_mm[i].x(), points_mm[i].y(), points_mm[i].z());
    image.emplace_back(rays[i].x(), rays[i].y());
  }
  std::vector<cv::Mat> rotations;
  std::vector<cv::Mat> translations;
  cv::solveP3P(object, image, cv::Mat::eye(3, 3, CV_64F), cv::noArray(), rotations, translations,
               cv::SOLVEPNP_AP3P);
  std::vector<Rigid> poses;
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    Eigen::Vector3d r;
    Rigid pose;
    cv::cv2eigen(rotations[i], r);
    cv::cv2eigen(translations[i], pose.t);
    pose.R = rotation_exp(r);
    if (r.allFinite() && pose.t.allFinite()) poses.push_back(pose);
  }
  return poses;
}

}  // namespace berth::host
