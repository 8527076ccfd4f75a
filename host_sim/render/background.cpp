#include "host_sim/render/background.hpp"

#include <algorithm>

#include "host_sim/render/clutter.hpp"
#include "host_sim/render/noise_field.hpp"
#include "host_sim/render/random.hpp"

namespace berth::host {
namespace {

// Space: next to nothing, and a few stars.
void draw_dark(const Background& background, Painter& painter, Plane& radiance) {
  constexpr int kMostStars = 24;
  std::fill(radiance.data.begin(), radiance.data.end(), static_cast<float>(background.level_dn));
  Random random(background.seed);
  const int stars = random.below(kMostStars);
  for (int i = 0; i < stars; ++i) {
    Spot star;
    star.center_px = {random.uniform(0.0, radiance.width), random.uniform(0.0, radiance.height)};
    star.long_radius_px = star.short_radius_px = 1.5;
    const double brightness = random.uniform();
    star.peak_dn = 300.0 * brightness * brightness * brightness;  // bright ones are rare
    painter.add_spot(star);
  }
}

// Clouds: bright, with soft structure at three scales.
void draw_bright(const Background& background, Plane& radiance) {
  Random random(background.seed);
  const float level = static_cast<float>(background.level_dn);
  const float strength = static_cast<float>(random.uniform(0.02, 0.25)) * level;
  std::fill(radiance.data.begin(), radiance.data.end(), level);
  add_noise_field(random.bits(), 320, 0.6f * strength, radiance);
  add_noise_field(random.bits(), 110, 0.3f * strength, radiance);
  add_noise_field(random.bits(), 30, 0.1f * strength, radiance);
}

void draw_payload(const Scene& scene, const Camera& camera, const Target& target, Painter& painter,
                  BackgroundScratch& scratch, const Plane& radiance) {
  Random random(scene.background.seed, 1);
  const int grain_px = 6 + random.below(40);
  scratch.texture.reset(radiance.width, radiance.height);
  add_noise_field(random.bits(), grain_px, 0.6f, scratch.texture);
  add_noise_field(random.bits(), 4 * grain_px, 0.4f, scratch.texture);
  painter.set_texture(&scratch.texture);
  const double depth_mm = random.uniform(0.0, 0.2) * target.plate_size_mm[0];
  const PayloadPlane plane(camera, scene.pose, depth_mm);
  draw_clutter(scene.background.seed, scene.background.level_dn, plane, target, painter);
}

}  // namespace

void draw_background(const Scene& scene, const Camera& camera, const Target& target, int margin_px,
                     BackgroundScratch& scratch, Plane& radiance) {
  const Background& background = scene.background;
  Painter painter(radiance, margin_px, scratch.coverage);
  switch (background.kind) {
    case BackgroundKind::kPlain:
      std::fill(radiance.data.begin(), radiance.data.end(),
                static_cast<float>(background.level_dn - scene.light.stray_dn));
      break;
    case BackgroundKind::kDark:
      draw_dark(background, painter, radiance);
      break;
    case BackgroundKind::kBright:
      draw_bright(background, radiance);
      break;
    case BackgroundKind::kClutter:
      draw_payload(scene, camera, target, painter, scratch, radiance);
      break;
  }
}

}  // namespace berth::host
