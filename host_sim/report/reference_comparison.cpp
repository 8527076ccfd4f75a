#include "host_sim/report/reference_comparison.hpp"

#include <cmath>

#include "host_sim/report/evaluate.hpp"

namespace berth::host {

ReferenceComparison compare_with_reference(const FrameRecord& record,
                                           const ReferencePose& reference) {
  ReferenceComparison out;
  if (!reference.found) return out;
  out.pose = DoublePose{Eigen::Quaterniond(reference.camera_from_target.R).normalized(),
                        reference.camera_from_target.t};
  if (out.pose->rotation.w() < 0) out.pose->rotation.coeffs() *= -1;
  const auto& s = reference.sigmas;
  out.sigma_rotation_deg = std::hypot(s[0], s[1], s[2]) * kDegreesPerRadian;
  out.sigma_translation_mm = std::hypot(s[3], s[4], s[5]);
  out.residual_px = reference.residual_px;
  if (!record.valid()) return out;
  const DoublePose ours = to_double(record.pose.camera_from_target);
  const auto covariance = to_double(record.pose.covariance);
  const double rotation_deg =
      std::sqrt(covariance.topLeftCorner<3, 3>().trace()) * kDegreesPerRadian;
  const double translation_mm = std::sqrt(covariance.bottomRightCorner<3, 3>().trace());
  out.is_compared = true;
  out.rotation_deg = rotation_error_deg(ours, *out.pose);
  out.translation_mm = translation_error_mm(ours, *out.pose);
  out.combined_rotation_deg = std::hypot(rotation_deg, out.sigma_rotation_deg);
  out.combined_translation_mm = std::hypot(translation_mm, out.sigma_translation_mm);
  return out;
}

}  // namespace berth::host
