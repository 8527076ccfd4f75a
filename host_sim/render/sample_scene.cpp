#include "host_sim/render/sample_scene.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/render/det_math.hpp"
#include "host_sim/render/random.hpp"
#include "host_sim/render/sample_hazards.hpp"
#include "host_sim/render/sample_pose.hpp"
#include "host_sim/render/sobol.hpp"

namespace berth::host {
namespace {

constexpr double kReferencePlate_mm = 120.0;
constexpr double kNearest_mm = 300.0;
constexpr double kFarthest_mm = 1500.0;
constexpr double kMostTilt_deg = 40.0;
constexpr double kBlackAlbedo = 0.04;
constexpr double kWhiteAlbedo = 0.85;

double lerp(double low, double high, double s) { return low + (high - low) * s; }

void sample_viewpoint(const SceneOptions& options, const SobolPoint& point, const Camera& camera,
                      const Target& target, Scene& scene) {
  const DistanceRange range = distance_range(target);
  const double span = det_log(range.farthest_mm / range.nearest_mm);
  Viewpoint& view = scene.viewpoint;
  view.distance_mm =
      options.distance_mm.value_or(range.nearest_mm * det_exp(span * point[Dimension::kDistance]));
  view.tilt_deg = options.tilt_deg.value_or(kMostTilt_deg * point[Dimension::kTilt]);
  view.tilt_direction_deg =
      options.tilt_direction_deg.value_or(360.0 * point[Dimension::kTiltDirection]);
  view.roll_deg = options.roll_deg.value_or(lerp(-180.0, 180.0, point[Dimension::kRoll]));
  const uint64_t seed = mix_bits(mix_bits(scene.seed, scene.index), 0x905e);
  scene.is_plate_inside = sample_position(point[Dimension::kPositionX],
                                          point[Dimension::kPositionY], seed, camera, target, view);
  scene.pose = pose_from_viewpoint(view, camera);
}

// Levels at the plate's brightest place. What a black albedo of 4 % cannot explain is stray light.
void sample_levels(const SobolPoint& point, Light& light) {
  light.black_dn = lerp(2.0, 60.0, point[Dimension::kBlack]);
  const double white = point[Dimension::kWhite];
  if (point[Dimension::kSaturation] < 0.10) {
    light.white_dn = lerp(255.0, 330.0, white);
  } else {
    light.white_dn = lerp(std::max(40.0, light.black_dn + 30.0), 255.0, white);
  }
  const double exposure_dn = (light.white_dn - light.black_dn) / (kWhiteAlbedo - kBlackAlbedo);
  light.stray_dn = std::max(0.0, light.black_dn - kBlackAlbedo * exposure_dn);
}

void sample_gradient(const SobolPoint& point, Light& light) {
  if (point[Dimension::kGradient] >= 0.30) return;
  const double most = std::min(4.0, (light.white_dn - light.black_dn) / 30.0);
  light.gradient_ratio = lerp(1.0, most, point[Dimension::kGradientRatio]);
  light.gradient_angle_rad = 2.0 * kPi * point[Dimension::kGradientDirection];
}

void sample_optics(const SobolPoint& point, Scene& scene) {
  scene.noise_dn = lerp(0.5, 6.0, point[Dimension::kNoise]);
  scene.optics.defocus_px = lerp(0.4, 2.0, point[Dimension::kDefocus]);
  scene.optics.motion_px = 6.0 * point[Dimension::kMotion];
  scene.optics.motion_angle_rad = kPi * point[Dimension::kMotionDirection];
}

void sample_background(const SobolPoint& point, Background& background) {
  const double u = point[Dimension::kBackground];
  if (u < 0.2) {
    background.kind = BackgroundKind::kDark;
    background.level_dn = 8.0 * u / 0.2;
  } else if (u < 0.3) {
    background.kind = BackgroundKind::kBright;
    background.level_dn = lerp(150.0, 270.0, (u - 0.2) / 0.1);
  } else {
    background.kind = BackgroundKind::kClutter;
    background.level_dn = lerp(0.15, 0.65, (u - 0.3) / 0.7) * 255.0;
  }
}

}  // namespace

DistanceRange distance_range(const Target& target) {
  const double scale =
      std::max(target.plate_size_mm[0], target.plate_size_mm[1]) / kReferencePlate_mm;
  return {kNearest_mm * scale, kFarthest_mm * scale};
}

Scene clean_scene(const Pose& pose) {
  Scene scene;
  scene.pose = pose;
  scene.light.white_dn = 200.0;
  scene.light.black_dn = 30.0;
  scene.optics.defocus_px = 0.7;
  scene.noise_dn = 2.0;
  scene.background = {BackgroundKind::kPlain, 115.0, 0};
  return scene;
}

Scene sample_scene(const SceneOptions& options, uint64_t index, const Camera& camera,
                   const Target& target) {
  const SobolPoint point(options.seed, index);
  Scene scene = clean_scene(Pose{});
  scene.seed = options.seed;
  scene.index = index;
  scene.has_target = options.with_target;
  const uint64_t key = mix_bits(options.seed, index);
  scene.noise_seed = mix_bits(key, 0x4015e);
  scene.background.seed = mix_bits(key, 0xbac);
  sample_viewpoint(options, point, camera, target, scene);
  if (options.clean) return scene;
  sample_levels(point, scene.light);
  sample_gradient(point, scene.light);
  sample_optics(point, scene);
  sample_background(point, scene.background);
  sample_hazards(point, options.share_occluded, target, scene);
  return scene;
}

}  // namespace berth::host
