#include "host_sim/campaign/frame_maker.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "host_sim/render/det_math.hpp"
#include "host_sim/render/outline.hpp"
#include "host_sim/render/sample_scene.hpp"
#include "host_sim/render/sobol.hpp"

namespace berth::host {
namespace {

constexpr double kSteepFrom_deg = 40.0, kSteepTo_deg = 60.0;
constexpr uint64_t kRollStream = 0x5011, kNearMissStream = 0x4e4d, kPhotoStream = 0x9407;

std::vector<cv::Point2f> to_cv(const Polygon& polygon) {
  std::vector<cv::Point2f> points;
  for (const Eigen::Vector2d& p : convex_hull(polygon)) {
    points.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
  }
  return points;
}

bool do_overlap(const std::vector<cv::Point2f>& a, const std::vector<cv::Point2f>& b) {
  std::vector<cv::Point2f> common;
  return cv::intersectConvexConvex(a, b, common) > 0.0f;
}

void remove_line_occluders(Scene& scene) {
  auto& all = scene.occluders;
  all.erase(
      std::remove_if(all.begin(), all.end(), [](const Occluder& o) { return o.marker == "line"; }),
      all.end());
}

double shift_px(NearMissKind kind, const Target& target, double amount, const Scene& scene,
                const Camera& camera) {
  return near_miss_shift_mm(kind, target, amount) * camera.fx / scene.pose.t.z();
}

}  // namespace

bool is_line_covered(const Pose& pose, const Camera& camera, const Target& target) {
  const View view{camera, pose};
  const auto line = to_cv(project_line(view, target.line));
  for (const Dot& dot : target.dots) {
    if (dot.center[2] == 0.0) continue;
    const Eigen::Vector3d center(dot.center[0], dot.center[1], dot.center[2]);
    const double radius = std::max(dot.radius, dot.collar_radius);
    if (do_overlap(line, to_cv(project_circle(view, center, radius)))) return true;
    if (dot.post_radius > 0.0 && do_overlap(line, to_cv(project_post(view, dot)))) return true;
  }
  return false;
}

Scene steep_scene(uint64_t seed, uint64_t index, const Camera& camera, const Target& target) {
  constexpr int kTries = 100;
  SceneOptions options;
  options.seed = seed;
  const SobolPoint point(seed, index);
  options.tilt_deg = kSteepFrom_deg + (kSteepTo_deg - kSteepFrom_deg) * point[Dimension::kTilt];
  Random rolls(mix_bits(seed, index), kRollStream);
  Scene scene = sample_scene(options, index, camera, target);
  for (int i = 0; i < kTries && is_line_covered(scene.pose, camera, target); ++i) {
    options.roll_deg = rolls.uniform(-180.0, 180.0);
    scene = sample_scene(options, index, camera, target);
  }
  remove_line_occluders(scene);
  return scene;
}

FrameMaker::FrameMaker(CampaignSet set, uint64_t seed, Camera camera, Target target,
                       std::optional<PhotoLibrary> photos)
    : set_(set),
      seed_(seed),
      camera_(std::move(camera)),
      target_(std::move(target)),
      photos_(std::move(photos)) {}

Scene FrameMaker::scene_with_target(uint64_t index) const {
  if (set_ == CampaignSet::kSteep) return steep_scene(seed_, index, camera_, target_);
  SceneOptions options;
  options.seed = seed_;
  if (set_ == CampaignSet::kHidden) options.share_occluded = 1.0;
  return sample_scene(options, index, camera_, target_);
}

CampaignFrame FrameMaker::near_miss(uint64_t index) const {
  SceneOptions options;
  options.seed = seed_;
  const uint64_t number = index / 2;  // near misses are a sequence of their own
  // Drawn, not in turn: parity decides a half of a Sobol sequence's first dimension.
  Random random(mix_bits(seed_, number), kNearMissStream);
  const NearMissKind kind = static_cast<NearMissKind>(random.below(kNearMissKinds));
  CampaignFrame frame;
  frame.kind = near_miss_name(kind);
  frame.scene = sample_scene(options, number, camera_, target_);
  frame.scene.has_target = kind != NearMissKind::kBackground;
  frame.scene.occluders.clear();  // they hide what is wrong, or stand where the line would be
  if (has_amount(kind)) frame.amount = draw_amount(kind, random);
  frame.shift_px = shift_px(kind, target_, frame.amount, frame.scene, camera_);
  if (kind == NearMissKind::kConcentric) {
    frame.scene.occluders = concentric_circles(target_, frame.scene.light, random);
  }
  frame.image = render_frame(frame.scene, camera_, near_miss_target(kind, target_, frame.amount));
  frame.scene.has_target = false;  // whatever was drawn is not the target
  return frame;
}

CampaignFrame FrameMaker::photo(uint64_t index) const {
  Random random(mix_bits(seed_, index / 2), kPhotoStream);
  CampaignFrame frame;
  frame.kind = "photo";
  frame.scene.has_target = false;
  frame.image = photos_->crop(camera_.width, camera_.height, random);
  return frame;
}

CampaignFrame FrameMaker::make(uint64_t index) const {
  if (set_ == CampaignSet::kEmpty) return index % 2 == 0 ? near_miss(index) : photo(index);
  CampaignFrame frame;
  frame.kind = "target";
  frame.scene = scene_with_target(index);
  frame.image = render_frame(frame.scene, camera_, target_);
  return frame;
}

}  // namespace berth::host
