#include "host_sim/render/clutter.hpp"

#include <algorithm>

#include "host_sim/render/clutter_parts.hpp"
#include "host_sim/render/det_math.hpp"

namespace berth::host {
namespace {

constexpr double kBorder_px = 60.0;  // parts beyond the image's border that reach into it

using DrawPart = void (*)(const Workbench&, const Place&, double);

// How many of a part a scene of density 1 shows, and their sizes in pixels.
struct PartRule {
  DrawPart draw;
  double count;
  double smallest_px;
  double largest_px;
};

// Large surfaces first, small parts on top of them.
constexpr PartRule kRules[] = {
    {draw_panel, 7, 180, 520},      {draw_foil, 2.5, 100, 380},
    {draw_panel, 7, 60, 220},       {draw_machined_circles, 2, 40, 170},
    {draw_grille, 2, 50, 160},      {draw_ring, 4, 40, 130},
    {draw_bolt_circle, 1, 40, 120}, {draw_bar, 8, 60, 320},
    {draw_disc, 4, 8, 60},          {draw_hole, 6, 6, 40},
    {draw_ring, 6, 10, 45},         {draw_cable, 3, 150, 500},
    {draw_bolt_row, 5, 20, 60},     {draw_bolt, 10, 3, 14},
    {draw_reflection, 4, 10, 160},
};

// Sizes are spread evenly in their logarithm: few large, many small parts.
double draw_size_px(const PartRule& rule, Random& random) {
  const double span = det_log(rule.largest_px / rule.smallest_px);
  return rule.smallest_px * det_exp(span * random.uniform());
}

int draw_count(double mean, Random& random) {
  const double low = 0.5 * mean;
  return static_cast<int>(random.uniform(low, mean + low) + random.uniform());
}

void draw_ground(const Workbench& bench) {
  Paint paint = bench.grey(0.4, 1.4);
  paint.texture = bench.random.uniform(0.0, 0.12);
  const Grid& all = bench.painter.limit();
  const double left = all.x0_px - 1.0;
  const double top = all.y0_px - 1.0;
  const double right = left + all.width + 1.0;
  const double bottom = top + all.height + 1.0;
  bench.painter.fill({{left, top}, {right, top}, {right, bottom}, {left, bottom}}, paint);
}

// A bracket under the plate, so that in some scenes a calm frame surrounds it.
void draw_bracket(const Workbench& bench, const Target& target) {
  const double longest = std::max(target.plate_size_mm[0], target.plate_size_mm[1]);
  const double rim = longest * bench.random.uniform(0.02, 0.2);
  const Place origin = bench.plane.place_of(0.0, 0.0);
  const double length = target.plate_size_mm[0] + 2.0 * rim;
  const double width = target.plate_size_mm[1] + 2.0 * rim;
  Paint paint = bench.grey(0.3, 2.0);
  paint.texture = bench.random.uniform(0.0, 0.08);
  bench.painter.fill(bench.plane.rectangle(origin, length, width, 0.0), paint);
  if (rim < 0.06 * longest || bench.random.chance(0.3)) return;
  for (const double u : {-0.5, 0.0, 0.5}) {
    for (const double v : {-0.5, 0.0, 0.5}) {
      if (u == 0.0 && v == 0.0) continue;
      draw_bolt(bench, bench.plane.place_of(u * (length - rim), v * (width - rim)), 0.22 * rim);
    }
  }
}

// Parts of the target's own kind and size that reach under the plate's border.
void draw_neighbours(const Workbench& bench, const Target& target) {
  const double half = 0.5 * std::max(target.plate_size_mm[0], target.plate_size_mm[1]);
  const DrawPart parts[] = {draw_ring,    draw_bar, draw_disc, draw_hole, draw_machined_circles,
                            draw_bolt_row};
  const int count = draw_count(5.0 * bench.style.density, bench.random);
  for (int i = 0; i < count; ++i) {
    const SinCos a = det_sincos(2.0 * kPi * bench.random.uniform());
    const double distance = half * bench.random.uniform(0.9, 2.2);
    const Place place = bench.plane.place_of(distance * a.cos, distance * a.sin);
    const double size = target.ring.outer * bench.random.uniform(0.15, 1.3);
    parts[bench.random.below(6)](bench, place, size);
  }
}

}  // namespace

void draw_clutter(uint64_t seed, double level_dn, const PayloadPlane& plane, const Target& target,
                  Painter& painter) {
  Random random(seed);
  ClutterStyle style;
  style.level_dn = level_dn;
  style.angle_rad = random.chance(0.5) ? 0.0 : random.uniform(0.0, kPi);
  style.density = random.uniform(0.3, 1.4);
  const Workbench bench{plane, painter, random, style};
  draw_ground(bench);
  for (const PartRule& rule : kRules) {
    const int count = draw_count(rule.count * style.density, random);
    for (int i = 0; i < count; ++i) {
      const Place place = plane.random_place(random, kBorder_px);
      rule.draw(bench, place, draw_size_px(rule, random) * place.mm_per_px);
    }
  }
  if (random.chance(0.5)) draw_bracket(bench, target);
  if (random.chance(0.7)) draw_neighbours(bench, target);
}

}  // namespace berth::host
