#include "bench/circles/conditions.hpp"

#include <cmath>
#include <opencv2/core.hpp>

#include "host_sim/render/sample_hazards.hpp"

namespace berth::bench {
namespace {

using host::Random;
using host::Scene;
using host::SceneOptions;
using host::Target;

constexpr std::uint64_t kSeed = 11;
constexpr std::uint64_t kStream = 0xc1c1;

Condition tilted(const std::string& name, double from_deg, double to_deg) {
  Condition c{name, {}, {}, {}};
  c.choose = [=](Random& random, SceneOptions& o) {
    o.tilt_deg = random.uniform(from_deg, to_deg);
  };
  return c;
}

Condition distant(const std::string& name, double from_mm, double to_mm) {
  Condition c{name, {}, {}, {}};
  c.choose = [=](Random& random, SceneOptions& o) {
    o.distance_mm = random.uniform(from_mm, to_mm);
  };
  return c;
}

Condition changed(const std::string& name,
                  std::function<void(Random&, const Target&, Scene&)> change) {
  return {name, {}, {}, std::move(change)};
}

host::Occluder disc(double x_mm, double y_mm, double radius_mm, double level_dn) {
  constexpr int kCorners = 120;
  host::Occluder o;
  o.level_dn = level_dn;
  for (int k = 0; k < kCorners; ++k) {
    const double t = 2 * CV_PI * k / kCorners;
    o.outline_mm.push_back({x_mm + radius_mm * std::cos(t), y_mm + radius_mm * std::sin(t)});
  }
  return o;
}

// Rings, discs, holes and concentric circles of about the ring's size all around the plate.
void surround(Random& random, const Target& target, Scene& scene) {
  const double reach = 0.5 * target.plate_size_mm[0] * std::sqrt(2.0), ring = target.ring.outer;
  const double light = scene.light.white_dn - scene.light.stray_dn;
  for (int k = 0; k < 10; ++k) {
    const double t = 2 * CV_PI * (k + 0.4 * random.uniform()) / 10;
    double radius = ring * random.uniform(0.7, 1.0);
    const double away = reach + radius + random.uniform(2.0, 30.0);
    const double x = away * std::cos(t), y = away * std::sin(t);
    bool is_light = random.chance(0.6);
    for (int circles = 1 + random.below(4); circles > 0; --circles) {
      const double level = is_light ? random.uniform(0.6, 1.0) : random.uniform(0.0, 0.3);
      scene.occluders.push_back(disc(x, y, radius, level * light));
      radius *= random.uniform(0.7, 0.9);
      is_light = !is_light;
    }
  }
}

void hide_quarter(Random& random, const Target& target, Scene& scene) {
  scene.occluders = {occlude_ring(target.ring, random.uniform(0.0, 2 * CV_PI))};
  scene.occluders[0].level_dn =
      random.uniform(0.0, 0.8) * (scene.light.white_dn - scene.light.stray_dn);
}

}  // namespace

std::vector<Condition> all_conditions() {
  Condition envelope{"the envelope as it is", {}, {}, {}};
  envelope.options.share_occluded = 0.2;
  std::vector<Condition> all = {
      envelope,
      tilted("tilt 0 to 20 deg", 0, 20),
      tilted("tilt 20 to 33 deg", 20, 33),
      tilted("tilt 33 to 45 deg: collar and D0 over the ring", 33, 45),
      tilted("tilt 45 to 60 deg", 45, 60),
      distant("300 to 500 mm", 300, 500),
      distant("1200 to 1500 mm", 1200, 1500),
      changed("a quarter of the ring hidden", hide_quarter),
      changed("motion blur 4 to 6 px",
              [](Random& r, const Target&, Scene& s) { s.optics.motion_px = r.uniform(4.0, 6.0); }),
      changed("defocus 1.5 to 2 px", [](Random& r, const Target&,
                                        Scene& s) { s.optics.defocus_px = r.uniform(1.5, 2.0); }),
      changed("rings, discs, holes, concentric circles around", surround),
      changed("structure up to the plate's border",
              [](Random& r, const Target&, Scene& s) {
                s.background = {host::BackgroundKind::kClutter, r.uniform(40.0, 165.0),
                                s.background.seed};
              }),
      changed("bright background at the plate's border", [](Random& r, const Target&, Scene& s) {
        s.background = {host::BackgroundKind::kBright, r.uniform(150.0, 270.0), s.background.seed};
      })};
  for (size_t c = 0; c < all.size(); ++c) {
    all[c].options.seed = kSeed + c;
    if (c > 0) all[c].options.share_occluded = 0;
  }
  return all;
}

host::Scene make_scene(const Condition& condition, std::uint64_t index, const host::Camera& camera,
                       const host::Target& target) {
  Random random(host::mix_bits(condition.options.seed, index), kStream);
  SceneOptions options = condition.options;
  if (condition.choose) condition.choose(random, options);
  Scene scene = sample_scene(options, index, camera, target);
  if (condition.change) condition.change(random, target, scene);
  return scene;
}

}  // namespace berth::bench
