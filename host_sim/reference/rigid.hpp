// Rigid transforms in double for the reference, and the rotation vectors that sigmas refer to.
#pragma once

#include <Eigen/Geometry>

namespace berth::host {

/// p_camera = R p_target + t; t in mm.
struct Rigid {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();
};

/// Rotation matrix of a rotation vector (rad).
inline Eigen::Matrix3d rotation_exp(const Eigen::Vector3d& v) {
  const double angle = v.norm();
  if (angle < 1e-300) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, v / angle).toRotationMatrix();
}

/// Rotation vector of a rotation matrix, length 0..pi (rad). Through the quaternion, which keeps
/// small angles to rounding error.
inline Eigen::Vector3d rotation_log(const Eigen::Matrix3d& R) {
  Eigen::Quaterniond q(R);
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const double sine = q.vec().norm();
  if (sine < 1e-300) return Eigen::Vector3d::Zero();
  return q.vec() * (2.0 * std::atan2(sine, q.w()) / sine);
}

}  // namespace berth::host
