// The pose stages in double: what the fixed-point ones are measured against.
//
// Refinement: minimise sum r_i^T S_i^-1 r_i over the pose, r_i the measured minus the predicted
// centre of marker i, by Gauss-Newton with R <- exp(delta) R, t <- t + dt and differences for the
// Jacobian. Covariance: the inverse of J^T S^-1 J, of (delta, dt) as design and packets define it.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "host_sim/io/camera_model.hpp"
#include "host_sim/io/target_file.hpp"
#include "host_sim/reference/rigid.hpp"

namespace berth::host {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

struct Observation {
  Eigen::Vector2d center_px;
  Eigen::Matrix2d covariance_px2 = Eigen::Matrix2d::Identity();
  std::function<Eigen::Vector2d(const Rigid&)> predict;
};

struct RefinedPose {
  Rigid camera_from_target;
  Matrix6d covariance;     ///< rad and mm, as if the observations' covariances were right
  double chi_squared = 0;  ///< whitened residuals, squared and summed
  double rms_px = 0;       ///< per coordinate
  bool has_converged = false;
};

/// At least three observations that determine the pose; otherwise it does not converge.
RefinedPose refine_pose(const std::vector<Observation>& observations, const Rigid& start);

/// Area centroids in the distorted image as observations: dots in the target's order, then the
/// ring, then the line. The measured centre is left for the caller to fill in.
std::vector<Observation> centroid_observations(const Camera& camera, const Target& target);

/// All poses that put the three points on the three rays (x/z, y/z), up to four; AP3P (Ke,
/// Roumeliotis 2017) of OpenCV. Empty for degenerate input.
std::vector<Rigid> solve_p3p(const std::vector<Eigen::Vector3d>& points_mm,
                             const std::vector<Eigen::Vector2d>& rays);

}  // namespace berth::host
