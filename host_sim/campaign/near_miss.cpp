#include "host_sim/campaign/near_miss.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "host_sim/render/det_math.hpp"

namespace berth::host {
namespace {

constexpr double kLeastChange = 0.10, kLargestChange = 0.18;

void turn(double& x, double& y, const SinCos& a) {
  const double turned_x = a.cos * x - a.sin * y;
  y = a.sin * x + a.cos * y;
  x = turned_x;
}

void remove_line(Target& target) { target.line.length = target.line.width = 0.0; }

void scale_flat_dots(double factor, Target& target) {
  for (Dot& dot : target.dots) {
    dot.center[0] *= factor;
    dot.center[1] *= factor;
  }
}

void change_dimension(NearMissKind kind, double amount, Target& target) {
  const double factor = 1.0 + amount;
  const double width = target.ring.outer - target.ring.inner;
  switch (kind) {
    case NearMissKind::kLineDistance:
      for (double& c : target.line.center) c *= factor;
      return;
    case NearMissKind::kLineTurned:
      turn(target.line.center[0], target.line.center[1], det_sincos(amount));
      target.line.angle_deg += amount / kRadPerDeg;
      return;
    case NearMissKind::kLineSlanted:
      target.line.angle_deg += amount / kRadPerDeg;
      return;
    case NearMissKind::kLineLength:
      target.line.length *= factor;
      return;
    case NearMissKind::kLineWidth:
      target.line.width *= factor;
      return;
    case NearMissKind::kRingRadius:
      target.ring.outer *= factor;
      target.ring.inner = target.ring.outer - width;
      return;
    case NearMissKind::kRingWidth:
      target.ring.inner = target.ring.outer - width * factor;
      return;
    case NearMissKind::kDotDistance:
      return scale_flat_dots(factor, target);
    case NearMissKind::kDotRadius:
      for (Dot& dot : target.dots) dot.radius *= factor;
      return;
    default:
      return;
  }
}

}  // namespace

const char* near_miss_name(NearMissKind kind) {
  static constexpr std::array<const char*, kNearMissKinds> kNames = {
      "no_line",    "line_distance", "line_turned", "line_slanted", "line_length",
      "line_width", "ring_radius",   "ring_width",  "dot_distance", "dot_radius",
      "no_dots",    "ring",          "disc",        "concentric",   "background"};
  return kNames.at(static_cast<size_t>(kind));
}

bool has_amount(NearMissKind kind) {
  return kind >= NearMissKind::kLineDistance && kind <= NearMissKind::kDotRadius;
}

Target near_miss_target(NearMissKind kind, const Target& target, double amount) {
  Target out = target;
  if (has_amount(kind)) change_dimension(kind, amount, out);
  const bool has_line = has_amount(kind) || kind == NearMissKind::kNoDots;
  if (!has_line) remove_line(out);
  if (kind >= NearMissKind::kNoDots) out.dots.clear();
  if (kind == NearMissKind::kDisc) out.ring.inner = 0.0;
  if (kind >= NearMissKind::kConcentric) out.ring.outer = out.ring.inner = 0.0;
  return out;
}

double near_miss_shift_mm(NearMissKind kind, const Target& target, double amount) {
  const double size = std::abs(amount);
  const double width = target.ring.outer - target.ring.inner;
  const double line_distance = std::hypot(target.line.center[0], target.line.center[1]);
  double dot_distance = 0.0, dot_radius = 0.0;
  for (const Dot& dot : target.dots) {
    dot_distance = std::max(dot_distance, std::hypot(dot.center[0], dot.center[1]));
    dot_radius = std::max(dot_radius, dot.radius);
  }
  switch (kind) {
    case NearMissKind::kLineDistance:
      return size * line_distance;
    case NearMissKind::kLineTurned:
      return 2.0 * line_distance * std::sin(0.5 * size);
    case NearMissKind::kLineSlanted:
      return 0.5 * target.line.length * std::sin(size);
    case NearMissKind::kLineLength:
      return 0.5 * size * target.line.length;
    case NearMissKind::kLineWidth:
      return 0.5 * size * target.line.width;
    case NearMissKind::kRingRadius:
      return size * target.ring.outer;
    case NearMissKind::kRingWidth:
      return size * width;
    case NearMissKind::kDotDistance:
      return size * dot_distance;
    case NearMissKind::kDotRadius:
      return size * dot_radius;
    default:
      return 0.0;
  }
}

double draw_amount(NearMissKind kind, Random& random) {
  const double sign = random.chance(0.5) ? 1.0 : -1.0;
  if (kind == NearMissKind::kLineTurned) return sign * random.uniform(12.0, 78.0) * kRadPerDeg;
  if (kind == NearMissKind::kLineSlanted) return sign * random.uniform(8.0, 30.0) * kRadPerDeg;
  return sign * random.uniform(kLeastChange, kLargestChange);
}

std::vector<Occluder> concentric_circles(const Target& target, const Light& light, Random& random) {
  constexpr int kCorners = 180;
  std::vector<Occluder> circles;
  double radius = 0.4 * target.plate_size_mm[0] * random.uniform(0.7, 1.2);
  const double step = radius / random.uniform(3.0, 12.0);
  bool is_light = random.chance(0.5);
  for (; radius > 0.5 * step; radius -= step * random.uniform(0.7, 1.3), is_light = !is_light) {
    Occluder circle;
    const double level = is_light ? random.uniform(0.6, 1.0) : random.uniform(0.0, 0.4);
    circle.level_dn = level * (light.white_dn - light.stray_dn);
    for (int i = 0; i < kCorners; ++i) {
      const SinCos a = det_sincos(2.0 * kPi * i / kCorners);
      circle.outline_mm.push_back({radius * a.cos, radius * a.sin});
    }
    circles.push_back(std::move(circle));
  }
  return circles;
}

}  // namespace berth::host
