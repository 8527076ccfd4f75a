#include "host_sim/reference/reference.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "host_sim/reference/blobs.hpp"
#include "host_sim/reference/flatten.hpp"
#include "host_sim/reference/identify.hpp"
#include "host_sim/reference/measure.hpp"

namespace berth::host {
namespace {

constexpr int kPasses = 3;
constexpr std::size_t kMinMarkers = 5;
constexpr double kOutlierSigmas = 5;
constexpr double kMaxReducedChi = 5;
// Three sigma below the limits of a false pose.
constexpr double kMaxSigma_rad = 0.0116;
constexpr double kMaxSigma_distance = 0.0066;

std::vector<Observation> observations_of(const std::vector<MeasuredMarker>& markers) {
  std::vector<Observation> observations;
  for (const MeasuredMarker& marker : markers) observations.push_back(marker.observation);
  return observations;
}

double normalised_residual(const Observation& o, const Rigid& pose) {
  const Eigen::Vector2d r = o.center_px - o.predict(pose);
  return std::sqrt(r.dot(o.covariance_px2.inverse() * r));
}

/// Index of the marker whose removal leaves the least chi squared, and the pose without it. The
/// marker with the largest residual need not be the wrong one.
struct Removal {
  std::size_t index = 0;
  RefinedPose pose;
};

Removal best_removal(const std::vector<MeasuredMarker>& markers, const Rigid& start) {
  std::optional<Removal> best;
  for (std::size_t i = 0; i < markers.size(); ++i) {
    std::vector<MeasuredMarker> others = markers;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const RefinedPose pose = refine_pose(observations_of(others), start);
    if (!best || pose.chi_squared < best->pose.chi_squared) best = Removal{i, pose};
  }
  return *best;
}

/// Refines and drops markers that contradict the others by more than their scatter explains.
RefinedPose consistent_pose(std::vector<MeasuredMarker>& markers, const Rigid& start) {
  RefinedPose pose = refine_pose(observations_of(markers), start);
  for (std::size_t n = markers.size(); n > kMinMarkers; --n) {
    const auto is_far = [&](const MeasuredMarker& m) {
      return normalised_residual(m.observation, pose.camera_from_target) > kOutlierSigmas;
    };
    if (std::none_of(markers.begin(), markers.end(), is_far)) break;
    const Removal removal = best_removal(markers, pose.camera_from_target);
    markers.erase(markers.begin() + static_cast<std::ptrdiff_t>(removal.index));
    pose = removal.pose;
  }
  return pose;
}

/// The plate mirrored at the line of sight: where the other minimum of a flat target lies.
Rigid mirrored(const Rigid& pose) {
  const Eigen::Vector3d sight = pose.t.normalized();
  const Eigen::Vector3d normal = pose.R.col(2);
  const Eigen::Vector3d other = 2 * sight.dot(normal) * sight - normal;
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(normal, other);
  return {turn.toRotationMatrix() * pose.R, pose.t};
}

ReferencePose failed(const std::string& why_not) {
  ReferencePose result;
  result.why_not = why_not;
  return result;
}

ReferencePose judged(const RefinedPose& pose, std::size_t markers) {
  const double freedom = 2.0 * static_cast<double>(markers) - 6;
  const double reduced_chi = std::sqrt(pose.chi_squared / freedom);
  if (!pose.has_converged) return failed("the refinement did not converge");
  if (!(reduced_chi < kMaxReducedChi)) return failed("the markers contradict each other");
  ReferencePose result;
  result.found = true;
  result.camera_from_target = pose.camera_from_target;
  // The scatter is known from few residuals: the variance of Student's t with that freedom.
  result.covariance =
      pose.covariance * std::max(1.0, reduced_chi * reduced_chi) * freedom / (freedom - 2);
  for (Eigen::Index i = 0; i < 6; ++i) {
    result.sigmas[static_cast<std::size_t>(i)] = std::sqrt(result.covariance(i, i));
  }
  result.residual_px = pose.rms_px;
  result.markers = static_cast<int>(markers);
  const double rotation = std::sqrt(result.covariance.diagonal().head<3>().sum());
  const double translation = std::sqrt(result.covariance.diagonal().tail<3>().sum());
  const double distance = pose.camera_from_target.t.norm();
  if (!(rotation < kMaxSigma_rad && translation < kMaxSigma_distance * distance)) {
    return failed("the markers do not determine the pose");
  }
  return result;
}

}  // namespace

ReferencePose reference_pose(const cv::Mat& gray, const Camera& camera, const Target& target) {
  if (gray.type() != CV_8UC1 || gray.cols != camera.width || gray.rows != camera.height) {
    return failed("the image is not 8-bit grey of the camera's size");
  }
  const cv::Mat bright = target.white_on_black ? gray : cv::Mat(255 - gray);
  std::optional<Rigid> pose = identify_target(bright, camera, target, find_blobs(bright));
  if (!pose) return failed("no target identified");
  cv::Mat1f levels;
  bright.convertTo(levels, CV_32F);
  RefinedPose refined;
  std::vector<MeasuredMarker> markers;
  for (int pass = 0; pass < kPasses; ++pass) {
    const cv::Mat1f flat = flatten_light(levels, camera, target, *pose);
    markers = measure_markers(flat, camera, target, *pose);
    if (markers.size() < kMinMarkers) return failed("fewer than five markers could be measured");
    refined = consistent_pose(markers, *pose);
    const RefinedPose other = refine_pose(observations_of(markers), mirrored(*pose));
    if (other.has_converged && other.chi_squared < refined.chi_squared) refined = other;
    pose = refined.camera_from_target;
  }
  return judged(refined, markers.size());
}

}  // namespace berth::host
