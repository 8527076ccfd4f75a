#include "host_sim/render/sample_hazards.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/render/det_math.hpp"
#include "host_sim/render/outline.hpp"
#include "host_sim/render/random.hpp"

namespace berth::host {
namespace {

constexpr double kShareShadowed = 0.20;
constexpr double kShareGlinting = 0.20;

double smallest_radius(const Target& target) {
  double radius = target.ring.outer;
  for (const Dot& dot : target.dots) radius = std::min(radius, dot.radius);
  return radius;
}

// One kind in three; then the place within the kind.
Occluder choose_occluder(double u, const Target& target, Random& random) {
  const int kind = std::min(2, static_cast<int>(3.0 * u));
  const double within = 3.0 * u - kind;
  if (kind == 0) {
    const size_t count = target.dots.size();
    const size_t i = std::min(count - 1, static_cast<size_t>(within * static_cast<double>(count)));
    return occlude_dot(target.dots[i], random.uniform(0.0, 0.5 * kPi));
  }
  if (kind == 1) return occlude_ring(target.ring, 2.0 * kPi * within);
  return occlude_line(target.line, within < 0.5 ? -1 : 1);
}

// A point of a marker, so that an edge through it crosses the marker.
std::array<double, 2> point_of_marker(const Target& target, Random& random) {
  const int pick = random.below(static_cast<int>(target.dots.size()) + 2);
  const SinCos a = det_sincos(2.0 * kPi * random.uniform());
  if (pick == 0) {
    const double radius = random.uniform(target.ring.inner, target.ring.outer);
    return {radius * a.cos, radius * a.sin};
  }
  if (pick == 1) {
    const Line& line = target.line;
    const SinCos along = det_sincos(line.angle_deg * kRadPerDeg);
    const double s = random.uniform(-0.45, 0.45) * line.length;
    return {line.center[0] + s * along.cos, line.center[1] + s * along.sin};
  }
  const Dot& dot = target.dots[static_cast<size_t>(pick - 2)];
  const double radius = dot.radius * 0.8 * random.uniform();
  return {dot.center[0] + radius * a.cos, dot.center[1] + radius * a.sin};
}

Shadow choose_shadow(double leaves, const Target& target, Random& random) {
  const auto [x, y] = point_of_marker(target, random);
  const SinCos normal = det_sincos(2.0 * kPi * random.uniform());
  Shadow shadow;
  shadow.normal_x = normal.cos;
  shadow.normal_y = normal.sin;
  shadow.offset_mm = normal.cos * x + normal.sin * y;
  // Half of the edges are sharp, half soft: up to two thirds of a dot's radius.
  shadow.penumbra_mm =
      random.chance(0.5) ? 0.0 : random.uniform(0.0, 0.67) * smallest_radius(target);
  shadow.leaves = leaves;
  return shadow;
}

Glint choose_glint(const Target& target, Random& random) {
  Glint glint;
  glint.x_mm = random.uniform(-0.5, 0.5) * target.plate_size_mm[0];
  glint.y_mm = random.uniform(-0.5, 0.5) * target.plate_size_mm[1];
  glint.radius_mm = random.uniform(0.25, 1.0) * smallest_radius(target);
  glint.peak_dn = random.uniform(100.0, 600.0);
  return glint;
}

}  // namespace

Occluder occlude_line(const Line& line, int side) {
  constexpr double kBeyond = 0.05;  // how far it reaches over the line's end, in lengths
  const SinCos a = det_sincos(line.angle_deg * kRadPerDeg);
  const double length = (0.5 + kBeyond) * line.length;
  const double middle = 0.5 * side * length;
  Occluder occluder;
  occluder.marker = "line";
  occluder.z_mm = -0.05 * line.width;
  occluder.outline_mm =
      rectangle_corners({line.center[0] + middle * a.cos, line.center[1] + middle * a.sin}, length,
                        1.6 * line.width, line.angle_deg * kRadPerDeg);
  return occluder;
}

Occluder occlude_ring(const Ring& ring, double start_rad) {
  constexpr int kParts = 24;
  const double width = ring.outer - ring.inner;
  Occluder occluder;
  occluder.marker = "ring";
  occluder.z_mm = -0.05 * width;
  for (int side = 0; side < 2; ++side) {
    const double radius = side == 0 ? ring.outer + 0.3 * width : ring.inner - 0.3 * width;
    for (int i = 0; i <= kParts; ++i) {
      const int step = side == 0 ? i : kParts - i;
      const SinCos a = det_sincos(start_rad + 0.5 * kPi * step / kParts);
      occluder.outline_mm.push_back({radius * a.cos, radius * a.sin});
    }
  }
  return occluder;
}

Occluder occlude_dot(const Dot& dot, double angle_rad) {
  Occluder occluder;
  occluder.marker = dot.name;
  occluder.z_mm = dot.center[2] - 0.05 * dot.radius;
  const double side = 2.5 * dot.radius;
  occluder.outline_mm = rectangle_corners({dot.center[0], dot.center[1]}, side, side, angle_rad);
  return occluder;
}

void sample_hazards(const SobolPoint& point, double share_occluded, const Target& target,
                    Scene& scene) {
  Random random(mix_bits(scene.seed, scene.index), 0x4a2a);
  const Light& light = scene.light;
  const double u = point[Dimension::kOcclusion];
  if (u < share_occluded) {
    Occluder occluder = choose_occluder(u / share_occluded, target, random);
    occluder.level_dn = random.uniform(0.0, 0.8) * (light.white_dn - light.stray_dn);
    scene.occluders.push_back(std::move(occluder));
  }
  if (point[Dimension::kShadow] < kShareShadowed) {
    const double leaves = 0.3 + 0.5 * point[Dimension::kShadowDepth];
    scene.light.shadow = choose_shadow(leaves, target, random);
  }
  if (point[Dimension::kGlint] < kShareGlinting) {
    scene.glints.push_back(choose_glint(target, random));
  }
}

}  // namespace berth::host
