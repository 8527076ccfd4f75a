// What counts: a frame's outcome judged against its ground truth (definitions: docs/replay.md).
//
//   e_R = angle of R_est R_true^T,  e_t = |t_est - t_true|,  Z = |t_true|
//   high precision: valid, e_R <= 0.015 deg (Z/300)^2 and e_t <= 0.2 mm (Z/300)^2
//   false pose:     valid and (e_R > 2 deg or e_t > 2 % of Z), or valid without a target
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/io/camera_model.hpp"
#include "host_sim/io/target_file.hpp"
#include "host_sim/report/frame_record.hpp"
#include "host_sim/report/truth.hpp"

namespace berth::host {

/// The pose a packet holds, in double.
DoublePose to_double(const WireTransform& pose);

/// Covariance of (delta, dt) in rad and mm, order rx ry rz tx ty tz.
Eigen::Matrix<double, 6, 6> to_double(const PoseCovariance& covariance);

/// Angle between two rotations, degrees.
double rotation_error_deg(const DoublePose& estimate, const DoublePose& truth);
double translation_error_mm(const DoublePose& estimate, const DoublePose& truth);

/// Tilt of a pose, degrees: between the plate's outward normal and the direction to the camera.
double tilt_deg(const DoublePose& pose);

/// The ring as an image of a pose shows it: image of its centre (not the centre of its image, which
/// lies up to 6 px beside it), semi-major axis of its outer edge, and the direction of the target's
/// x axis in the image, from u towards v.
struct RingView {
  Eigen::Vector2d center_px = Eigen::Vector2d::Zero();
  double radius_px = 0;
  double roll_rad = 0;
};
RingView ring_view(const Camera& camera, const Target& target, const DoublePose& pose);

/// One frame against its truth.
struct Verdict {
  bool has_target = false;
  bool identified = false;            // correctly
  bool false_identification = false;  // accepted something else
  bool high_precision = false;
  bool false_pose = false;
  bool is_easy = false;  // contrast >= 60 DN, noise <= 3 DN, nothing hidden
  bool has_error = false;
  double rotation_deg = 0, translation_mm = 0;                  // errors
  Eigen::Vector3d rotation_axes_deg = Eigen::Vector3d::Zero();  // the same per camera axis
  Eigen::Vector3d translation_axes_mm = Eigen::Vector3d::Zero();
  double distance_mm = 0, tilt_deg = 0;  // of the truth
  std::optional<double> nees;            // e^T C^-1 e with 6 degrees of freedom
};

/// Contrast of at least 60 DN, noise of at most 3 DN, nothing hidden by an occluder.
bool is_easy_scene(const TruthRow& truth);

Verdict judge(const FrameRecord& record, const TruthRow& truth, const Camera& camera,
              const Target& target);

/// e^T C^-1 e of a pose with covariance; nothing where the covariance is not positive definite.
std::optional<double> normalised_error_squared(const DoublePose& estimate, const DoublePose& truth,
                                               const Eigen::Matrix<double, 6, 6>& covariance);

}  // namespace berth::host
