#include "accuracy/tag_campaign.hpp"

#include <cmath>
#include <memory>

#include "accuracy/tag_readers.hpp"
#include "pipeline/chain_tools.hpp"

namespace berth::accuracy {
namespace {

constexpr double kDegPerRad = 180 / 3.14159265358979323846;

// Rotation and translation error, the same over the bound; empty where nothing was read.
std::vector<double> score(const host::Pose& estimate, const host::Pose& truth,
                          const Matrix6& bound) {
  const double rotation = Eigen::AngleAxisd(estimate.R * truth.R.transpose()).angle() * kDegPerRad;
  const double translation = (estimate.t - truth.t).norm();
  return {rotation, translation, rotation / rotation_sigma_deg(bound),
          translation / translation_sigma_mm(bound)};
}

host::Pose host_pose(const RigidTransform& pose) {
  host::Pose out;
  for (int i = 0; i < 3; ++i) {
    out.t[i] = std::ldexp(pose.translation_mm[i].raw(), -18);
    for (int k = 0; k < 3; ++k) out.R(i, k) = std::ldexp(pose.rotation(i, k).raw(), -30);
  }
  return out;
}

std::vector<double> score_ours(const Rig& rig, const host::Scene& scene) {
  const host::Image8 image = host::render_frame(scene, rig.host_camera, rig.host_target);
  const FrameResult result = test::process(image, rig.host_camera, rig.host_target);
  if (!result.valid) return {};
  return score(host_pose(result.pose.camera_from_target), scene.pose,
               bound_from_outlines(scene, rig.host_camera, rig.host_target));
}

// Numbers of all readers in a row, four each; -1 where one missed.
std::vector<double> measure_scene(const Rig& rig, const host::Scene& scene) {
  const host::Target plate = bare_plate(rig.host_target);
  const TagPattern tag = tag_36h11(rig.host_target.plate_size_mm[0]);
  const host::Image8 image =
      host::quantise(render_tag(scene, rig.host_camera, plate, tag), rig.host_camera.width,
                     rig.host_camera.height, scene.noise_dn, scene.noise_seed);
  const Matrix6 bound = bound_of_tag(scene, rig.host_camera, plate, tag);
  std::vector<double> row;
  const auto add = [&](const std::vector<double>& numbers) {
    for (size_t k = 0; k < 4; ++k) row.push_back(numbers.empty() ? -1 : numbers[k]);
  };
  const auto add_corners = [&](const std::optional<TagCorners>& corners) {
    if (!corners) return add({});
    const host::Pose pose = pose_from_corners(*corners, tag, rig.host_camera, scene.pose);
    add(score(pose, scene.pose, bound));
  };
  add(score_ours(rig, scene));
  add_corners(read_apriltag(image));
  add_corners(read_aruco(image, ArucoRefinement::kSubpixel));
  add_corners(read_aruco(image, ArucoRefinement::kApriltag));
  return row;
}

}  // namespace

std::vector<ReaderScore> compare_readers(const Rig& rig, const TiltBand& tilt, double distance_mm,
                                         int images, Ledger& ledger) {
  std::vector<ReaderScore> scores(4);
  const char* names[] = {"Berthmark", "AprilTag 3", "ArUco subpixel", "ArUco AprilTag"};
  for (size_t r = 0; r < scores.size(); ++r) scores[r].name = names[r];
  for (int i = 0; i < images; ++i) {
    host::SceneOptions options;
    options.seed = 53;
    options.clean = true;
    options.distance_mm = distance_mm;
    options.tilt_deg = tilt.from_deg + (tilt.to_deg - tilt.from_deg) * (i + 0.5) / images;
    const std::string key = "tags/" + std::to_string(distance_mm) + "/" +
                            std::to_string(*options.tilt_deg) + "/" + std::to_string(i);
    const std::vector<double> row = ledger.values(key, [&] {
      return measure_scene(rig, host::sample_scene(options, static_cast<std::uint64_t>(i),
                                                   rig.host_camera, rig.host_target));
    });
    for (size_t r = 0; r < scores.size() && row.size() == 16; ++r) {
      ReaderScore& s = scores[r];
      ++s.images;
      const double* v = &row[4 * r];
      if (v[0] < 0) {
        ++s.missed;
        continue;
      }
      s.rotation_deg += v[0] * v[0];
      s.translation_mm += v[1] * v[1];
      s.rotation_over_bound += v[2] * v[2];
      s.translation_over_bound += v[3] * v[3];
    }
  }
  for (ReaderScore& s : scores) {
    const int n = std::max(1, s.images - s.missed);
    for (double* v :
         {&s.rotation_deg, &s.translation_mm, &s.rotation_over_bound, &s.translation_over_bound}) {
      *v = std::sqrt(*v / n);
    }
  }
  return scores;
}

}  // namespace berth::accuracy
