#include "target/verify_sizes.hpp"

#include "fixed/trigonometry.hpp"
#include "target/verify_profiles.hpp"
#include "target/verify_widths.hpp"

namespace berth {
namespace {

constexpr int kDirections = 24, kStations = 12, kDiameters = 6;
static_assert(kMaxSites >= kDirections && kMaxSites >= kStations);
static_assert(kMaxSites >= kDiameters * kMaxDots);
constexpr int kMinDirections = 9, kMinStations = 4, kMinDiameters = 12;
constexpr int kSigmas = 2, kBandSigmas = 2;  // at each end of a comparison

constexpr int q12(double v) { return static_cast<int>(v * kOne + 0.5); }

// sigma / r of a disc by rho in steps of 0.05, and the part of a band's level that is left in its
// middle by sigma / width in steps of 0.05: both computed from Gaussian blur, sampled as here. A
// box of equal variance (motion) differs by less than 4 % of sigma and 3 % of the level lost.
constexpr int kTableStep = q12(0.05);
constexpr int kBlurByRho[8] = {0,          q12(0.0445), q12(0.0885), q12(0.1335),
                               q12(0.179), q12(0.228),  q12(0.286),  q12(0.367)};
constexpr int kLeftByBlur[11] = {q12(1.0),    q12(1.0),    q12(0.9962), q12(0.9758),
                                 q12(0.9401), q12(0.8963), q12(0.8505), q12(0.8074),
                                 q12(0.7693), q12(0.7370), q12(0.7096)};

int look_up(const int* table, int count, int x) {
  const int last = count - 2, i = x / kTableStep < last ? x / kTableStep : last;
  const int beyond = x - i * kTableStep < kTableStep ? x - i * kTableStep : kTableStep;
  return table[i] + (table[i + 1] - table[i]) * beyond / kTableStep;
}

// A width of few pixels above the noise: it takes all of them.
bool is_noisy(const Eye& eye) {
  constexpr int kClear_px = 400;  // times contrast over noise: one row sees a width to 1 %
  const Mm ring = eye.target.ring_outer_mm - eye.target.ring_inner_mm;
  const Mm width = ring < eye.target.line_width_mm ? ring : eye.target.line_width_mm;
  const std::int64_t depth = eye.view.camera_from_target.translation_mm[2].raw();
  if (depth <= 0) return false;
  const std::int64_t width_px = std::int64_t{eye.view.camera.fx.raw()} * width.raw() / depth;
  return shift_round(width_px * eye.contrast, 16) < std::int64_t{kClear_px} * eye.noise;
}

Sites ring_sites(const Eye& eye) {
  const Mm middle = fraction_of(eye.target.ring_outer_mm + eye.target.ring_inner_mm, 1, 2);
  const Mm way = fraction_of(eye.target.ring_outer_mm - eye.target.ring_inner_mm, 16, kBandSteps);
  // Besides, a third of the arc to the next one.
  const Mm aside = is_noisy(eye) ? fraction_of(middle, 2 * 355, 113 * 3 * kDirections) : Mm(0);
  Sites sites;
  for (int k = 0; k < kDirections; ++k) {
    const SinCos a = sin_cos(part_of_turn(k, kDirections));
    const Track track{middle * a.cos, middle * a.sin,   way * a.cos,
                      way * a.sin,    -(aside * a.sin), aside * a.cos};
    add_site(eye, track, k, false, sites);
  }
  return sites;
}

// A track along or across the bar from a place by its own axes.
struct Bar {
  const TargetModel& target;
  SinCos a;
  explicit Bar(const TargetModel& t) : target(t), a(sin_cos(t.line_angle)) {}
  Track track(Mm along, Mm aside, Mm way_along, Mm way_aside) const {
    return {target.line_x_mm + turn_x(along, aside),
            target.line_y_mm + turn_y(along, aside),
            turn_x(way_along, way_aside),
            turn_y(way_along, way_aside),
            Mm(0),
            Mm(0)};
  }
  Track across(Mm along, Mm way) const { return track(along, Mm(0), Mm(0), way); }
  Track across(Mm along, Mm way, Mm beside) const {
    Track t = across(along, way);
    t.aside_x = turn_x(beside, Mm(0));
    t.aside_y = turn_y(beside, Mm(0));
    return t;
  }
  Mm turn_x(Mm u, Mm v) const { return u * a.cos - v * a.sin; }
  Mm turn_y(Mm u, Mm v) const { return u * a.sin + v * a.cos; }
};

Sites line_sites(const Eye& eye) {
  const Bar bar(eye.target);
  const Mm way = fraction_of(eye.target.line_width_mm, 16, kBandSteps);
  const Mm reach = fraction_of(eye.target.line_length_mm, 1, 2) - eye.target.line_width_mm;
  const Mm beside = is_noisy(eye) ? fraction_of(reach, 2, 3 * kStations) : Mm(0);
  Sites sites;
  for (int k = 0; k < kStations; ++k) {
    const Mm along = fraction_of(reach, 2 * k - kStations + 1, kStations);
    add_site(eye, bar.across(along, way, beside), k, false, sites);
    if (2 * k < kStations) sites.first_half = sites.count;
  }
  return sites;
}

/// Of the flat dots, and the light they show; a raised one has no plate around it.
Size dot_area(const Eye& eye, Mm& mean_radius, Light& light) {
  Sites sites;
  int flat = 0;
  std::int64_t radii = 0;
  Grey contrast[kMaxDots] = {}, sides = 0, sum = 0;
  for (int d = 0; d < eye.target.dot_count; ++d) {
    const Dot& dot = eye.target.dots[d];
    if (dot.center_mm[2].raw() != 0) continue;
    ++flat;
    radii += dot.radius_mm.raw();
    const Mm way = fraction_of(dot.radius_mm, 16, kDotSteps);
    const int first = sites.count;
    for (int k = 0; k < kDiameters; ++k) {
      const SinCos a = sin_cos(part_of_turn(k, 2 * kDiameters));
      const Track track{dot.center_mm[0], dot.center_mm[1], way * a.cos, way * a.sin, Mm(0), Mm(0)};
      add_site(eye, track, k + d, true, sites);
    }
    if (sites.count < first + kDiameters) continue;
    for (int k = first; k < sites.count; ++k) {
      contrast[d] += sites.site[k].strength;
      sides += sites.site[k].sides;
      sum += sites.site[k].contrast;
    }
    contrast[d] /= kDiameters * kDotNominal;
  }
  light = fit_light(eye.target, contrast);
  // What lies beyond the plate's border blurs into the dots' black.
  if (16 * sides > sum) light.is_known = false;
  if (flat == 0) return {};
  mean_radius = Mm::from_wide(radii / flat);
  constexpr int kWeights = 16 * kInner * (kInner + 1);
  return summarize(sites, kDotNominal, kMinDiameters, eye.noise_energy(kWeights));
}

// How far one end of the bar lies beyond its place, in 1/256 of a step. False where the image
// ends.
bool measure_end(const Eye& eye, int side, std::int32_t& beyond_q8) {
  constexpr int kOutside = 8;  // a width beyond the end: a dot may follow
  const Bar bar(eye.target);
  const Mm half = fraction_of(eye.target.line_length_mm, side, 2), width = eye.target.line_width_mm;
  const Mm way = fraction_of(width, 16, kBandSteps);
  Grey level[kSamples], white = 0, black = 0;
  for (int k = 1; k <= 3; ++k) {  // a half to one and a half widths before the end
    const Mm along = half - fraction_of(width, side * k, 2);
    if (!read_profile(eye.view, bar.across(along, way), 0, level)) return false;
    black += before_of(level) + after_of(level);
    if (k == 1) continue;
    for (int i = kReach - kMiddle; i <= kReach + kMiddle; ++i) white += level[i];
  }
  black /= 18;
  const Grey contrast = white / 10 - black;
  beyond_q8 = -kBandSteps * 256;
  if (contrast < eye.least()) return true;  // hidden, or at least a width too short
  std::int32_t sum = 0;                     // below 63 * 4080
  for (int k = -1; k <= 1; ++k) {
    const Track track = bar.track(half, fraction_of(width, k, 4), fraction_of(way, side, 1), Mm(0));
    if (!read_profile(eye.view, track, 5 * k, level)) return false;
    for (int i = 0; i <= kReach + kOutside; ++i) sum += level[i] - black;
  }
  beyond_q8 = sum * 256 / (3 * contrast) - (2 * kReach + 1) * 128;
  return true;
}

// Both ends off the same way: their mean, which a pose off along the line leaves alone, as far as
// the pose may be off. What hides one end says nothing of the other.
std::int32_t common_fault(std::int32_t a, std::int32_t b, std::int32_t of_pose) {
  if ((a > 0) != (b > 0)) return 0;
  const std::int32_t way = a > 0 ? 1 : -1;
  const std::int32_t lesser = way * (way * a < way * b ? a : b), mean = way * (a + b) / 2;
  return way * (mean < lesser + of_pose ? mean : lesser + of_pose);
}

EdgeShift line_end(const Eye& eye) {
  std::int32_t a = 0, b = 0;
  if (!measure_end(eye, -1, a) || !measure_end(eye, 1, b)) return {};
  EdgeShift end;
  end.is_known = true;
  const Mm width = eye.target.line_width_mm;
  const std::int32_t fault = common_fault(a, b, kBandSteps * 256 / 16);
  end.shift_mm = fraction_of(width, fault, kBandSteps * 256);
  // Black is the mean of 18 samples and counts 21 times: five sigma of a pixel.
  const Mm least = fraction_of(eye.target.line_length_mm, 1, 56);
  end.tolerance_mm = least + fraction_of(width, 5 * eye.noise, kBandSteps * eye.contrast);
  return end;
}

EdgeShift shift_of_dots(const Size& size, Mm radius) {
  EdgeShift s;
  s.is_known = size.is_known;
  const int off = size.ratio - kOne;
  s.shift_mm = fraction_of(radius, off / 2 - off * off / (8 * kOne), kOne);
  s.tolerance_mm = fraction_of(radius, q12(0.01) + size.sigma * kSigmas, kOne);
  // A curved edge is moved by up to a quarter more or less than a straight one.
  s.tolerance_mm += fraction_of(abs(s.shift_mm), 1, 4);
  return s;
}

// `left`: of the band's level in its middle. `more`: tolerance beside that of the description and
// the scatter, 12 bits of the width.
EdgeShift shift_of_band(const Size& size, Mm width, int left, int more) {
  EdgeShift s;
  s.is_known = size.is_known;
  s.shift_mm = fraction_of(width, size.ratio * left / kOne - kOne, 2 * kOne);
  s.tolerance_mm = fraction_of(width, q12(0.02) + size.sigma * kBandSigmas + more, 2 * kOne);
  return s;
}

int left_in_middle(Mm sigma, Mm width) {
  if (width.raw() <= 0) return 0;
  return look_up(kLeftByBlur, 11, static_cast<int>(std::int64_t{sigma.raw()} * kOne / width.raw()));
}

// A shadow over two of four dots looks like a slope of the light. Around the ring it does not:
// opposite quarters differ. The collar may hide a quarter.
bool is_light_even(const Sites& ring) {
  const std::int64_t median = median_ratio(ring, 0, ring.count);
  std::int64_t ratio[4] = {};
  int kept = 0;
  for (int part = 0; part < 4; ++part) {
    std::int64_t strength = 0, contrast = 0;
    int seen = 0;
    for (int i = ring.count * part / 4; i < ring.count * (part + 1) / 4; ++i) {
      const Site& s = ring.site[i];
      if (is_outlier(s, median)) continue;
      ++seen;
      strength += s.strength;
      contrast += s.contrast;
    }
    kept += seen;
    if (seen >= kDirections / 8) ratio[part] = strength * kOne / contrast;
  }
  const auto are_alike = [](std::int64_t a, std::int64_t b) {
    return a == 0 || b == 0 || (16 * a < 17 * b && 16 * b < 17 * a);
  };
  return 3 * kept > 2 * kDirections && are_alike(ratio[0], ratio[2]) &&
         are_alike(ratio[1], ratio[3]);
}

// In a deep shadow ends are lost in the noise, which is no shorter line.
bool is_clear(const Eye& eye, const Sites& bar) {
  std::int64_t contrast = 0;
  for (int i = 0; i < bar.count; ++i) contrast += bar.site[i].contrast;
  return contrast > 2 * std::int64_t{eye.least()} * bar.count;
}

// Light in the place of the contrasts seen, if it is even.
bool exchange_both(Sites& ring, Sites& bar) {
  if (!exchange_light(ring)) return false;
  if (is_light_even(ring) && exchange_light(bar)) return true;
  exchange_light(ring);
  return false;
}

}  // namespace

Sizes measure_sizes(const TargetView& view, const TargetModel& target,
                    const ReferenceValues& reference, std::uint16_t noise_q8) {
  Sizes sizes;
  Eye eye{view, target, reference.white - reference.black, noise_q8 * kGreyOne / 256, {}};
  if (eye.contrast <= 0) return sizes;
  Mm radius;
  Light light;
  const Size dots = dot_area(eye, radius, light);
  eye.light = light;
  const Mm width = target.ring_outer_mm - target.ring_inner_mm;
  sizes.sigma_mm = fraction_of(radius, look_up(kBlurByRho, 8, dots.rho > 0 ? dots.rho : 0), kOne);
  // Blur beyond the table: what it leaves in the middle is not known, but that it is as much in
  // bands of one width.
  const bool is_sharp = dots.is_known && dots.rho <= q12(0.37);
  const bool is_wide = 5 * std::int64_t{sizes.sigma_mm.raw()} > width.raw();
  Sites ring = ring_sites(eye), bar = line_sites(eye);
  if (is_clear(eye, bar)) sizes.line_end = line_end(eye);
  const bool by_light = light.is_known && is_wide && exchange_both(ring, bar);
  const Size ring_size = summarize(ring, kBandNominal, kMinDirections, 0);
  const Size line = summarize(bar, kBandNominal, kMinStations, 0);
  const int ring_left = left_in_middle(sizes.sigma_mm, width);
  const int line_left = left_in_middle(sizes.sigma_mm, target.line_width_mm);
  const int of_ring = (kOne - ring_left) / 6;
  const BandLevels left{ring_left, line_left};
  if (is_sharp || ring_left == line_left) {
    sizes.line_to_ring =
        compare_widths(target, ring, kDirections, line, by_light ? BandLevels{} : left, eye.noise);
  }
  if (!is_sharp) return sizes;
  sizes.dots = shift_of_dots(dots, radius);
  if (by_light) {
    const int of_light = q12(0.02) + dots.sigma * kSigmas;
    // Relative to the dots now; the line's ends are not.
    sizes.dots.shift_mm = Mm(0);
    sizes.line_end.tolerance_mm += fraction_of(sizes.sigma_mm, 1, 2);
    sizes.ring = shift_of_band(ring_size, width, kOne, of_ring + of_light);
  } else {
    sizes.ring = shift_of_band(ring_size, width, ring_left, of_ring);
  }
  return sizes;
}

bool are_sizes_consistent(const Sizes& sizes) {
  const SizeRatio& r = sizes.line_to_ring;
  if (r.is_known && (r.off > r.tolerance || r.off < -r.tolerance)) return false;
  // Gamma of 0.45 to 2.2 moves an edge by 0.65 sigma; white clipped at a third of its level by
  // more.
  Mm high = fraction_of(sizes.sigma_mm, sizes.dots.is_known ? 3 : 1, 1), low = -high;
  for (const EdgeShift& s : {sizes.ring, sizes.dots, sizes.line_end}) {
    if (!s.is_known) continue;
    const Mm above = s.shift_mm + s.tolerance_mm, below = s.shift_mm - s.tolerance_mm;
    if (above < high) high = above;
    if (below > low) low = below;
  }
  return low <= high;
}

}  // namespace berth
