#include "p3p_campaign.hpp"

#include <cmath>
#include <cstdio>

#include "grunert.hpp"
#include "pose/select.hpp"
#include "scenes.hpp"

namespace berth::test {
namespace {

/// Dots shrunk to points, so that P3P alone is judged.
TargetModel points_of_ct1(double scale) {
  TargetModel target = ct1(scale);
  for (Dot& dot : target.dots) dot.radius_mm = Mm(0);
  return target;
}

void compare_with_twin(const CameraD& camera, const TargetModel& target, const MarkerSet& markers,
                       const Candidate& candidate, const PoseD& truth, double scale,
                       P3pCampaign& out) {
  Eigen::Vector3d bearing[3], point[3];
  for (int i = 0; i < 3; ++i) {
    const Marker& marker = markers.markers[candidate.triple[i]];
    const Eigen::Vector2d pixel(marker.center_px[0].raw() / 65536.0,
                                marker.center_px[1].raw() / 65536.0);
    bearing[i] = undistort(camera, pixel).homogeneous().normalized();
    point[i] = dot_center(target, candidate.triple[i]);
  }
  const PoseD fixed = to_double(candidate.camera_from_target);
  PoseD twin;
  if (!refine_distances(bearing, point, fixed, twin)) {
    ++out.twin_missing;
    return;
  }
  const Bound bound = clean_bound(truth, scale);
  const double ratio =
      std::max(rotation_error_rad(fixed.rotation, twin.rotation) / bound.rotation_rad,
               (fixed.translation_mm - twin.translation_mm).norm() / bound.translation_mm);
  if (ratio > 0.1) ++out.above_tenth;
  out.worst_twin_ratio = std::max(out.worst_twin_ratio, ratio);
}

}  // namespace

P3pCampaign run_p3p_campaign(std::int64_t count, std::uint64_t seed,
                             const P3pConditions& conditions) {
  const double noise_px = conditions.noise_px, scale = conditions.scale;
  const CameraD camera = conditions.has_distortion ? hec1_camera() : ideal_camera();
  const Camera fixed_camera = to_fixed(camera);
  SelectionLimits limits;
  if (conditions.all_triples) limits.min_triples = limits.max_triples;
  Envelope envelope(seed);
  P3pCampaign out;
  for (out.poses = 0; out.poses < count; ++out.poses) {
    const double size =
        scale > 0 ? scale : std::exp(envelope.uniform(std::log(0.25), std::log(4.0)));
    const TargetModel target = points_of_ct1(size);
    const PoseD truth = envelope.draw(camera, size);
    std::vector<Eigen::Vector2d> pixels;
    for (int i = 0; i < target.dot_count; ++i) {
      pixels.push_back(
          project(camera, truth.rotation * dot_center(target, i) + truth.translation_mm));
      if (noise_px > 0) {
        pixels.back() += noise_px * Eigen::Vector2d(envelope.normal(), envelope.normal());
      }
    }
    const MarkerSet markers = markers_at(target, pixels, 0.05);
    DotObservations dots;
    observe_dots(target, markers, dots);
    CandidateList list;
    select_candidates(fixed_camera, dots, limits, list);
    double rotation_deg = 180, translation_ratio = 1;
    if (list.count > 0) {
      const PoseD pose = to_double(list.best[0].camera_from_target);
      rotation_deg = rotation_error_rad(pose.rotation, truth.rotation) * 180 / M_PI;
      translation_ratio =
          (pose.translation_mm - truth.translation_mm).norm() / truth.translation_mm.norm();
      compare_with_twin(camera, target, markers, list.best[0], truth, size, out);
    }
    out.worst_rotation_deg = std::max(out.worst_rotation_deg, rotation_deg);
    out.worst_translation_ratio = std::max(out.worst_translation_ratio, translation_ratio);
    if (rotation_deg > 1 || translation_ratio > 0.01) {
      ++out.failures;
      char line[200];
      std::snprintf(line, sizeof line,
                    "pose %lld: Z %.1f mm, tilt %.2f deg, error %.3f deg %.3f %%",
                    static_cast<long long>(out.poses), truth.translation_mm.norm(),
                    truth.tilt_rad * 180 / M_PI, rotation_deg, 100 * translation_ratio);
      out.listed.push_back(line);
    }
  }
  return out;
}

}  // namespace berth::test
