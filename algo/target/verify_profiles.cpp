#include "target/verify_profiles.hpp"

#include "fixed/linear.hpp"
#include "fixed/roots.hpp"

namespace berth {
namespace {

// Strength of a profile over the ramp between its ends. |level| <= 4080, |v| <= 8160.
Site strength_of(const Grey (&level)[kSamples], int phase, bool is_diameter) {
  const Grey before = before_of(level), after = after_of(level);
  Site s;
  for (int k = kReach - kInner; k <= kReach + kInner; ++k) {
    const Grey ramp = (before * (kSamples - 2 - k) + after * (k - 1)) / (3 * (kSamples - 3));
    const std::int32_t v = level[k] - ramp;
    const int way = 16 * (k - kReach) + phase;
    const int weight = is_diameter ? (way < 0 ? -way : way) : 16;
    s.strength += weight * v;
    s.moment += way * v;
    s.energy += std::int64_t{weight} * v * v;
    if (k >= kReach - kMiddle && k <= kReach + kMiddle) s.contrast += v;
  }
  s.contrast /= 2 * kMiddle + 1;
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

// Pixels of a track to second order in the way along it: three projections instead of 25.
bool read_profile(const TargetView& view, const Track& t, int phase, Grey (&level)[kSamples]) {
  const Vec2Px m = view.pixel(Vec3Mm(t.x, t.y, Mm(0)));
  const Vec2Px a = view.pixel(Vec3Mm(t.x - t.dx, t.y - t.dy, Mm(0)));
  const Vec2Px b = view.pixel(Vec3Mm(t.x + t.dx, t.y + t.dy, Mm(0)));
  for (int k = 0; k < kSamples; ++k) {
    const int way = 16 * (k - kReach) + phase;  // 256: all of it
    Vec2Px at;
    for (int i = 0; i < 2; ++i) {
      const std::int64_t first = std::int64_t{b[i].raw()} - a[i].raw();
      const std::int64_t second =
          std::int64_t{b[i].raw()} + a[i].raw() - 2 * std::int64_t{m[i].raw()};
      at[i] = Px::saturated(m[i].raw() + shift_round(first * way, 9) +
                            shift_round(second * (way * way), 17));
    }
    level[k] = sample(view.image, at);
    if (level[k] == kNoGrey) return false;
  }
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
  if (eye.light.is_known) s.contrast = eye.light.at(track.x, track.y);
  if (s.contrast > 0) sites.site[sites.count++] = s;
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
  std::int64_t strength = 0, contrast = 0, energy = 0, product = 0, moment = 0;
  for (int i = 0; i < sites.count; ++i) {
    const Site& s = sites.site[i];
    if (is_outlier(s, median)) continue;
    ++kept;
    strength += s.strength;
    contrast += s.contrast;
    energy += s.energy - noise_energy;
    moment += s.moment;
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
  size.offset = static_cast<int>(16 * moment / strength);
  return size;
}

}  // namespace berth
