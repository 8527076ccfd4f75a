#include "host_sim/report/evaluate.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace berth::host {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Rotation vector of R_est R_true^T, radians, axes of the camera.
Eigen::Vector3d rotation_vector(const DoublePose& estimate, const DoublePose& truth) {
  Eigen::Quaterniond d = estimate.rotation * truth.rotation.conjugate();
  if (d.w() < 0) d.coeffs() = -d.coeffs();
  const double sine = d.vec().norm();
  // 2 atan2(|v|, w) v / |v|, by its limit where the axis vanishes.
  return sine < 1e-12 ? Eigen::Vector3d(2 * d.vec())
                      : Eigen::Vector3d(2 * std::atan2(sine, d.w()) / sine * d.vec());
}

Eigen::Vector2d project_point(const Camera& camera, const DoublePose& pose, double x, double y) {
  return project(camera, pose.rotation * Eigen::Vector3d(x, y, 0) + pose.translation_mm);
}

/// Whether stage 3's ring lies within 5 % of its image radius and 5 degrees of roll of the truth.
bool is_where_it_is(const FrameRecord& record, const TruthRow& truth, const Camera& camera,
                    const Target& target) {
  const RingView real = ring_view(camera, target, *truth.pose);
  const AlgorithmPacket& a = record.algorithm;
  const Eigen::Vector2d seen(to_double(a.ring_center_px[0]), to_double(a.ring_center_px[1]));
  const double roll = std::remainder(to_double(a.roll) - real.roll_rad, 2 * kPi);
  return (seen - real.center_px).norm() <= 0.05 * real.radius_px && std::abs(roll) <= kPi / 36;
}

void judge_pose(const FrameRecord& record, const DoublePose& truth, Verdict& verdict) {
  const DoublePose estimate = to_double(record.pose.camera_from_target);
  verdict.has_error = true;
  verdict.rotation_deg = rotation_error_deg(estimate, truth);
  verdict.translation_mm = translation_error_mm(estimate, truth);
  verdict.rotation_axes_deg = rotation_vector(estimate, truth) * (180 / kPi);
  verdict.translation_axes_mm = estimate.translation_mm - truth.translation_mm;
  verdict.nees = normalised_error_squared(estimate, truth, to_double(record.pose.covariance));
  const double scale = verdict.distance_mm * verdict.distance_mm / (300.0 * 300.0);
  verdict.high_precision = record.valid() && verdict.rotation_deg <= 0.015 * scale &&
                           verdict.translation_mm <= 0.2 * scale;
  verdict.false_pose = record.valid() && (verdict.rotation_deg > 2.0 ||
                                          verdict.translation_mm > 0.02 * verdict.distance_mm);
}

}  // namespace

DoublePose to_double(const WireTransform& pose) {
  DoublePose out;
  for (int i = 0; i < 3; ++i) out.translation_mm[i] = to_double(pose.translation_mm[i]);
  const Quaternion& q = pose.rotation;
  out.rotation = Eigen::Quaterniond(to_double(q.w), to_double(q.x), to_double(q.y), to_double(q.z))
                     .normalized();
  return out;
}

Eigen::Matrix<double, 6, 6> to_double(const PoseCovariance& covariance) {
  Eigen::Matrix<double, 6, 1> sigma;
  for (int i = 0; i < 3; ++i) {
    sigma[i] = to_double(covariance.sigma_rotation[i]);
    sigma[3 + i] = to_double(covariance.sigma_translation_mm[i]);
  }
  Eigen::Matrix<double, 6, 6> out = Eigen::Matrix<double, 6, 6>::Identity();
  int k = 0;
  for (int i = 0; i < 6; ++i) {
    for (int j = i + 1; j < 6; ++j) {
      out(i, j) = out(j, i) = to_double(covariance.correlation[k++]);
    }
  }
  return sigma.asDiagonal() * out * sigma.asDiagonal();
}

double rotation_error_deg(const DoublePose& estimate, const DoublePose& truth) {
  return rotation_vector(estimate, truth).norm() * (180 / kPi);
}

double translation_error_mm(const DoublePose& estimate, const DoublePose& truth) {
  return (estimate.translation_mm - truth.translation_mm).norm();
}

double tilt_deg(const DoublePose& pose) {
  // The outward normal is -z of the target; the camera is at -R^T t.
  const Eigen::Vector3d to_camera = -(pose.rotation.conjugate() * pose.translation_mm);
  const double cosine = -to_camera.z() / to_camera.norm();
  return std::acos(std::min(1.0, std::max(-1.0, cosine))) * (180 / kPi);
}

RingView ring_view(const Camera& camera, const Target& target, const DoublePose& pose) {
  constexpr int kPoints = 72;
  std::vector<cv::Point2f> outline;
  const Eigen::Vector2d origin = project_point(camera, pose, 0, 0);
  for (int i = 0; i < kPoints; ++i) {
    const double angle = 2 * kPi * i / kPoints;
    const Eigen::Vector2d p = project_point(camera, pose, target.ring.outer * std::cos(angle),
                                            target.ring.outer * std::sin(angle)) -
                              origin;
    outline.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
  }
  const cv::RotatedRect ellipse = cv::fitEllipseDirect(outline);
  RingView view;
  view.center_px = origin;
  view.radius_px = 0.5 * std::max(ellipse.size.width, ellipse.size.height);
  const Eigen::Vector2d x_axis =
      project_point(camera, pose, 1, 0) - project_point(camera, pose, -1, 0);
  view.roll_rad = std::atan2(x_axis.y(), x_axis.x());
  return view;
}

std::optional<double> normalised_error_squared(const DoublePose& estimate, const DoublePose& truth,
                                               const Eigen::Matrix<double, 6, 6>& covariance) {
  // Scaled to correlations first: rad^2 and mm^2 lie many orders of magnitude apart.
  const Eigen::Matrix<double, 6, 1> variance = covariance.diagonal();
  if (!(variance.minCoeff() > 0)) return std::nullopt;
  const Eigen::Matrix<double, 6, 1> weight = variance.cwiseSqrt().cwiseInverse();
  const Eigen::Matrix<double, 6, 6> correlation =
      weight.asDiagonal() * covariance * weight.asDiagonal();
  const Eigen::LLT<Eigen::Matrix<double, 6, 6>> cholesky(correlation);
  if (cholesky.info() != Eigen::Success) return std::nullopt;
  Eigen::Matrix<double, 6, 1> error;
  error << rotation_vector(estimate, truth), estimate.translation_mm - truth.translation_mm;
  return cholesky.matrixL().solve(weight.cwiseProduct(error)).squaredNorm();
}

bool is_easy_scene(const TruthRow& truth) {
  const auto contrast = truth.number("contrast_dn");
  const auto noise = truth.number("noise_dn");
  const std::string hidden = truth.text("hidden");
  return contrast && noise && *contrast >= 60 && *noise <= 3 &&
         (hidden.empty() || hidden == "none" || hidden == "0");
}

Verdict judge(const FrameRecord& record, const TruthRow& truth, const Camera& camera,
              const Target& target) {
  Verdict verdict;
  verdict.has_target = truth.pose.has_value();
  if (!verdict.has_target) {
    verdict.false_identification = record.identified();
    verdict.false_pose = record.valid();
    return verdict;
  }
  verdict.distance_mm = truth.pose->translation_mm.norm();
  verdict.tilt_deg = berth::host::tilt_deg(*truth.pose);
  verdict.is_easy = is_easy_scene(truth);
  verdict.identified = record.identified() && is_where_it_is(record, truth, camera, target);
  verdict.false_identification = record.identified() && !verdict.identified;
  if (record.has_pose()) judge_pose(record, *truth.pose, verdict);
  return verdict;
}

}  // namespace berth::host
