#include "target/verify_profiles.hpp"

#include "fixed/linear.hpp"
#include "fixed/roots.hpp"

namespace berth {
namespace {

// Strength of a profile over the ramp between its ends. |level| <= 4080, |v| <= 8160.
Site strength_of(const Grey (&level)[kSamples], int phase, bool is_diameter) {
  // The ramp and its slope with 10 bits: below 2^22 and 2^18.
  const Grey before = before_of(level), after = after_of(level);
  const std::int32_t slope = (after - before) * 1024 / (3 * (kSamples - 3));
  std::int32_t ramp = before * 1024 / 3 + slope * (kReach - kInner - 1);
  Site s;
  s.sides = (before < after ? after - before : before - after) / 3;
  for (int k = -kInner; k <= kInner; ++k, ramp += slope) {
    const std::int32_t v = level[kReach + k] - (ramp >> 10);
    const int way = 16 * k + phase;
    const int weight = is_diameter ? (way < 0 ? -way : way) : 16;
    s.strength += weight * v;
    s.energy += std::int64_t{weight * v} * v;
    if (k >= -kMiddle && k <= kMiddle) s.contrast += v;
  }
  s.contrast /= 2 * kMiddle + 1;
  for (int k = 1; k <= kMiddle; ++k) s.lean += level[kReach + k] - level[kReach - k];
  return s;
}

// Samples of neighbouring profiles are shifted by eighths of a step, so that sharp edges meet all
// phases: -7/16 .. 7/16.
constexpr int phase_of(int index) { return 2 * (index * 3 % 8) - 7; }

// Half of the line may lie behind something: of its halves the one that is nearer to the
// description.
std::int32_t typical_ratio(const Sites& sites, int nominal) {
  if (sites.first_half == 0) return median_ratio(sites, 0, sites.count);
  const std::int32_t a = median_ratio(sites, 0, sites.first_half) - 64 * nominal;
  const std::int32_t b = median_ratio(sites, sites.first_half, sites.count) - 64 * nominal;
  return 64 * nominal + ((a < 0 ? -a : a) < (b < 0 ? -b : b) ? a : b);
}

}  // namespace

Mm fraction_of(Mm length, std::int32_t numerator, std::int32_t denominator) {
  return Mm::from_wide(std::int64_t{length.raw()} * numerator / denominator);
}

bool read_profile(const TargetView& view, const Track& t, int phase, Grey (&level)[kSamples]) {
  constexpr int kLongest = Scan::kStep * kReach + Scan::kStep / 2;
  const int way = phase - Scan::kStep * kReach;
  const Scan scan(view, t.x, t.y, t.dx, t.dy, kLongest);
  if (!scan.is_inside()) return false;
  scan.read(view.image, way, kSamples, level);
  if (t.aside_x.raw() == 0 && t.aside_y.raw() == 0) return true;
  const Vec2Px aside = view.pixel(t.x + t.aside_x, t.y + t.aside_y) - scan.middle();
  const Scan left = scan.moved(view.image, -aside), right = scan.moved(view.image, aside);
  if (!left.is_inside() || !right.is_inside()) return false;
  Grey before[kSamples], after[kSamples];
  left.read(view.image, way, kSamples, before);
  right.read(view.image, way, kSamples, after);
  for (int k = 0; k < kSamples; ++k) level[k] = (before[k] + level[k] + after[k]) / 3;
  return true;
}

Light fit_light(const TargetModel& target, const Grey (&contrast)[kMaxDots]) {
  Light light;
  std::int64_t matrix[3][3] = {}, vector[3] = {}, row[3];
  int count = 0;
  for (int d = 0; d < target.dot_count; ++d) {
    if (contrast[d] == 0) continue;
    Light::row_at(target.dots[d].center_mm[0], target.dots[d].center_mm[1], row);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) matrix[i][j] += row[i] * row[j];
      vector[i] += row[i] * contrast[d];
    }
    ++count;
  }
  SpdSystem<3> system;
  if (count < 4 || !system.factor(matrix) || !system.solve(vector, light.plane, 16)) return light;
  light.is_known = true;
  for (int d = 0; d < target.dot_count; ++d) {
    if (contrast[d] == 0) continue;
    const Grey off =
        contrast[d] - light.at(target.dots[d].center_mm[0], target.dots[d].center_mm[1]);
    if (25 * (off < 0 ? -off : off) > contrast[d]) light.is_known = false;
  }
  return light;
}

void add_site(const Eye& eye, const Track& track, int index, bool is_diameter, Sites& sites) {
  Grey level[kSamples];
  if (!read_profile(eye.view, track, phase_of(index), level)) return;
  Site s = strength_of(level, phase_of(index), is_diameter);
  if (s.contrast <= eye.least() || s.strength <= 0) return;
  s.index = index;
  if (eye.light.is_known) s.lit = eye.light.at(track.x, track.y);
  sites.site[sites.count++] = s;
}

bool exchange_light(Sites& sites) {
  for (int i = 0; i < sites.count; ++i) {
    if (sites.site[i].lit <= 0) return false;
  }
  for (int i = 0; i < sites.count; ++i) {
    const std::int32_t contrast = sites.site[i].contrast;
    sites.site[i].contrast = sites.site[i].lit;
    sites.site[i].lit = contrast;
  }
  return true;
}

std::int32_t median_ratio(const Sites& sites, int first, int end) {
  std::int32_t sorted[kMaxSites];
  int count = 0;
  for (int i = first; i < end; ++i, ++count) {
    const Site& s = sites.site[i];
    const auto r = static_cast<std::int32_t>(std::int64_t{s.strength} * 64 / s.contrast);
    int k = count;
    for (; k > 0 && sorted[k - 1] > r; --k) sorted[k] = sorted[k - 1];
    sorted[k] = r;
  }
  return count > 0 ? sorted[count / 2] : 0;
}

bool is_outlier(const Site& s, std::int64_t typical) {
  const std::int64_t off = std::int64_t{s.strength} * 64 - typical * s.contrast;
  return 5 * (off < 0 ? -off : off) > typical * s.contrast;
}

Size summarize(const Sites& sites, int nominal, int least_sites, std::int64_t noise_energy) {
  Size size;
  if (sites.count < least_sites) return size;
  const std::int64_t median = typical_ratio(sites, nominal);
  int kept = 0;
  std::int64_t strength = 0, contrast = 0, energy = 0, product = 0, lean = 0;
  for (int i = 0; i < sites.count; ++i) {
    const Site& s = sites.site[i];
    if (is_outlier(s, median)) continue;
    ++kept;
    strength += s.strength;
    contrast += s.contrast;
    energy += s.energy - noise_energy;
    lean += s.lean;
    product += std::int64_t{s.strength} * s.contrast;
  }
  if (kept < least_sites) return size;
  std::uint64_t scatter = 0;  // 48 (2^23)^2
  for (int i = 0; i < sites.count; ++i) {
    const Site& s = sites.site[i];
    if (is_outlier(s, median)) continue;
    const std::int64_t off = s.strength - s.contrast * strength / contrast;
    scatter += static_cast<std::uint64_t>(off * off);
  }
  size.is_known = true;
  size.ratio = static_cast<int>(strength * kOne / (contrast * nominal));
  size.sigma = static_cast<int>(std::int64_t{isqrt(scatter)} * size.ratio / strength) + 1;
  size.rho = kOne - static_cast<int>(energy * kOne / product);
  size.lean = static_cast<int>(lean * kOne / (kMiddle * contrast));
  return size;
}

}  // namespace berth
