#include "host_sim/render/clutter_parts.hpp"

#include <algorithm>

#include "host_sim/render/det_math.hpp"

namespace berth::host {
namespace {

Place shifted(const Workbench& bench, const Place& place, double dx_mm, double dy_mm) {
  return bench.plane.place_of(place.x_mm + dx_mm, place.y_mm + dy_mm);
}

Paint scaled(Paint paint, double factor) {
  paint.level_dn *= factor;
  paint.slope_x *= factor;
  paint.slope_y *= factor;
  return paint;
}

// A slope that changes the level by up to `share` across `size_px`.
void slope_randomly(Random& random, double share, double size_px, Paint& paint) {
  const double most = share * paint.level_dn / std::max(8.0, size_px);
  paint.slope_x = random.uniform(-most, most);
  paint.slope_y = random.uniform(-most, most);
}

void draw_annulus(const Workbench& bench, const Place& place, double outer_mm, double inner_mm,
                  const Paint& paint) {
  const Polygon outer = bench.plane.circle(place, outer_mm);
  const Polygon inner = bench.plane.circle(place, inner_mm);
  if (!outer.empty() && !inner.empty()) bench.painter.fill(outer, paint, inner);
}

}  // namespace

Paint Workbench::grey(double low, double high) const {
  Paint paint;
  paint.level_dn = style.level_dn * random.uniform(low, high);
  return paint;
}

double Workbench::direction() const {
  const int quarter = random.below(4);
  const double turn = random.chance(0.15) ? random.uniform(0.0, kPi) : 0.0;
  return style.angle_rad + 0.5 * kPi * quarter + turn;
}

void draw_panel(const Workbench& bench, const Place& place, double size_mm) {
  const double aspect = bench.random.uniform(0.35, 1.0);
  const double angle = bench.direction();
  const double rim_mm = bench.random.uniform(1.0, 3.5) * place.mm_per_px;
  Paint paint = bench.grey(0.35, 1.7);
  const Paint rim = scaled(paint, bench.random.chance(0.6) ? 0.45 : 1.5);
  slope_randomly(bench.random, 0.6, size_mm / place.mm_per_px, paint);
  paint.texture = bench.random.uniform(0.0, 0.12);
  bench.painter.fill(bench.plane.rectangle(place, size_mm, aspect * size_mm, angle), rim);
  bench.painter.fill(
      bench.plane.rectangle(place, size_mm - 2.0 * rim_mm, aspect * size_mm - 2.0 * rim_mm, angle),
      paint);
}

// Crumpled insulation: three fans of facets between a middle, a ring of folds and a ragged border,
// each facet with a grey of its own.
void draw_foil(const Workbench& bench, const Place& place, double size_mm) {
  constexpr int kFolds = 9;
  using Corner = std::array<double, 2>;
  Random& random = bench.random;
  std::array<Corner, kFolds> fold;
  std::array<Corner, kFolds> border;
  for (int i = 0; i < kFolds; ++i) {
    const SinCos a = det_sincos(2.0 * kPi * (i + random.uniform(-0.3, 0.3)) / kFolds);
    const double inner = size_mm * random.uniform(0.12, 0.32);
    const double outer = size_mm * random.uniform(0.36, 0.6);
    fold[i] = {place.x_mm + inner * a.cos, place.y_mm + inner * a.sin};
    border[i] = {place.x_mm + outer * a.cos, place.y_mm + outer * a.sin};
  }
  const Corner middle{place.x_mm, place.y_mm};
  const double brightness = random.uniform(0.5, 1.3);
  const double facet_px = 0.4 * size_mm / place.mm_per_px;
  for (int i = 0; i < kFolds; ++i) {
    const int next = (i + 1) % kFolds;
    const std::array<Corner, 3> facets[] = {{middle, fold[i], fold[next]},
                                            {fold[i], border[i], border[next]},
                                            {fold[i], fold[next], border[next]}};
    for (const auto& facet : facets) {
      Paint paint = bench.grey(0.3 * brightness, 1.8 * brightness);
      slope_randomly(random, 0.8, facet_px, paint);
      paint.texture = 0.15;
      bench.painter.fill(bench.plane.polygon({facet[0], facet[1], facet[2]}), paint);
    }
  }
}

void draw_ring(const Workbench& bench, const Place& place, double radius_mm) {
  const double inner = radius_mm * bench.random.uniform(0.55, 0.92);
  Paint paint = bench.grey(0.1, 2.4);
  slope_randomly(bench.random, 0.4, 2.0 * radius_mm / place.mm_per_px, paint);
  if (bench.random.chance(0.35)) {
    bench.painter.fill(bench.plane.circle(place, radius_mm), bench.grey(0.1, 1.6));
  }
  draw_annulus(bench, place, radius_mm, inner, paint);
  if (bench.random.chance(0.3)) {
    draw_disc(bench, place, inner * bench.random.uniform(0.15, 0.5));
  }
}

void draw_disc(const Workbench& bench, const Place& place, double radius_mm) {
  Paint paint = bench.grey(0.1, 2.4);
  slope_randomly(bench.random, 0.5, 2.0 * radius_mm / place.mm_per_px, paint);
  bench.painter.fill(bench.plane.circle(place, radius_mm), paint);
}

// Dark, with a lit inner wall on one side.
void draw_hole(const Workbench& bench, const Place& place, double radius_mm) {
  const SinCos side = det_sincos(bench.style.angle_rad + 1.0);
  bench.painter.fill(bench.plane.circle(place, radius_mm), bench.grey(0.9, 1.8));
  const Place inner =
      shifted(bench, place, 0.14 * radius_mm * side.cos, 0.14 * radius_mm * side.sin);
  bench.painter.fill(bench.plane.circle(inner, 0.84 * radius_mm), bench.grey(0.02, 0.2));
}

void draw_machined_circles(const Workbench& bench, const Place& place, double radius_mm) {
  const Paint base = bench.grey(0.5, 1.6);
  bench.painter.fill(bench.plane.circle(place, radius_mm), base);
  const int grooves = 2 + bench.random.below(6);
  const double share = bench.random.uniform(0.2, 0.7);
  const double contrast = bench.random.uniform(0.4, 1.5);
  for (int i = 0; i < grooves; ++i) {
    const double outer = radius_mm * (1.0 - (i + 0.3) / (grooves + 1.0));
    const double inner = outer - share * radius_mm / (grooves + 1.0);
    draw_annulus(bench, place, outer, inner, scaled(base, contrast));
  }
  if (bench.random.chance(0.6)) draw_hole(bench, place, 0.12 * radius_mm);
}

void draw_bar(const Workbench& bench, const Place& place, double length_mm) {
  const double width = length_mm * bench.random.uniform(0.04, 0.16);
  const double angle = bench.direction();
  const SinCos a = det_sincos(angle);
  const Paint paint = bench.grey(0.1, 2.4);
  const Place shade = shifted(bench, place, -0.3 * width * a.sin, 0.3 * width * a.cos);
  bench.painter.fill(bench.plane.rectangle(shade, length_mm, width, angle), scaled(paint, 0.3));
  bench.painter.fill(bench.plane.rectangle(place, length_mm, width, angle), paint);
}

void draw_bolt(const Workbench& bench, const Place& place, double radius_mm) {
  bench.painter.fill(bench.plane.circle(place, 1.35 * radius_mm), bench.grey(0.15, 0.6));
  bench.painter.fill(bench.plane.circle(place, radius_mm), bench.grey(0.9, 2.5));
  const double socket = 0.85 * radius_mm;
  const double angle = bench.random.uniform(0.0, kPi);
  bench.painter.fill(bench.plane.rectangle(place, socket, socket, angle), bench.grey(0.1, 0.5));
}

void draw_bolt_row(const Workbench& bench, const Place& place, double pitch_mm) {
  const int count = 3 + bench.random.below(6);
  const SinCos a = det_sincos(bench.direction());
  for (int i = 0; i < count; ++i) {
    draw_bolt(bench, shifted(bench, place, i * pitch_mm * a.cos, i * pitch_mm * a.sin),
              0.16 * pitch_mm);
  }
}

void draw_bolt_circle(const Workbench& bench, const Place& place, double radius_mm) {
  draw_annulus(bench, place, 1.2 * radius_mm, 0.8 * radius_mm, bench.grey(0.4, 1.8));
  const int count = 6 + 2 * bench.random.below(4);
  for (int i = 0; i < count; ++i) {
    const SinCos a = det_sincos(2.0 * kPi * i / count);
    draw_bolt(bench, shifted(bench, place, radius_mm * a.cos, radius_mm * a.sin), 0.09 * radius_mm);
  }
}

// A bent band: a parabola in the part's own axes, with a bright line along it.
void draw_cable(const Workbench& bench, const Place& place, double length_mm) {
  constexpr int kParts = 20;
  const double width = length_mm * bench.random.uniform(0.015, 0.05);
  const double sag = length_mm * bench.random.uniform(-0.4, 0.4);
  const SinCos a = det_sincos(bench.direction());
  const Paint paint = bench.grey(0.1, 1.2);
  for (const double share : {1.0, 0.3}) {
    std::vector<std::array<double, 2>> corners;
    for (int i = 0; i <= 2 * kParts + 1; ++i) {
      const int part = i <= kParts ? i : 2 * kParts + 1 - i;
      const double s = static_cast<double>(part) / kParts - 0.5;
      const double u = s * length_mm;
      const double v = sag * (4.0 * s * s - 1.0) + (i <= kParts ? -0.5 : 0.5) * width * share;
      corners.push_back({place.x_mm + a.cos * u - a.sin * v, place.y_mm + a.sin * u + a.cos * v});
    }
    bench.painter.fill(bench.plane.polygon(corners), share == 1.0 ? paint : scaled(paint, 1.8));
  }
}

void draw_grille(const Workbench& bench, const Place& place, double size_mm) {
  const double angle = bench.direction();
  const SinCos a = det_sincos(angle);
  const int slots = 4 + bench.random.below(7);
  bench.painter.fill(bench.plane.rectangle(place, 1.1 * size_mm, 1.1 * size_mm, angle),
                     bench.grey(0.6, 1.6));
  const Paint slot = bench.grey(0.05, 0.4);
  for (int i = 0; i < slots; ++i) {
    const double v = size_mm * ((i + 0.5) / slots - 0.5);
    const Place middle = shifted(bench, place, -a.sin * v, a.cos * v);
    bench.painter.fill(bench.plane.rectangle(middle, size_mm, 0.45 * size_mm / slots, angle), slot);
  }
}

void draw_reflection(const Workbench& bench, const Place& place, double size_mm) {
  Spot spot;
  spot.center_px = bench.plane.pixel_of(place.x_mm, place.y_mm);
  spot.long_radius_px = size_mm / place.mm_per_px;
  spot.short_radius_px = spot.long_radius_px * bench.random.uniform(0.1, 1.0);
  spot.angle_rad = bench.random.uniform(0.0, kPi);
  spot.peak_dn = bench.random.uniform(20.0, 200.0);
  bench.painter.add_spot(spot);
}

}  // namespace berth::host
