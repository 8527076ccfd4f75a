#include "pose/outline_levels.hpp"

#include "fixed/linear.hpp"
#include "fixed/wide.hpp"

namespace berth {
namespace {

constexpr int kRefits = 2;
constexpr int kTriples = 32;
constexpr std::int32_t kMinContrast = 4 << kLevelFraction;
constexpr std::int32_t kMaxLevel = 400 << kLevelFraction;

// Plane through one level of the sectors; `use` selects them.
bool fit_plane(const OutlineLevels& levels, int sectors, const bool* use, bool contrast,
               LightPlane& plane) {
  std::int64_t matrix[3][3] = {}, vector[3] = {}, solution[3];
  int count = 0;
  for (int k = 0; k < sectors; ++k) {
    if (!use[k]) continue;
    const SectorLevel& s = levels.sectors[k];
    // Coordinates in mm Q<4>, 1 as Q<10>: about the same size, for the condition.
    const std::int32_t row[3] = {1 << 10, s.x.raw() >> 14, s.y.raw() >> 14};
    const std::int32_t level = contrast ? s.contrast : s.black;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j <= i; ++j) add_product(matrix[i][j], row[j], row[i]);
      add_product(vector[i], level, row[i]);
    }
    ++count;
  }
  if (count < 6) return false;
  SpdSystem<3> system;
  if (!system.factor(matrix) || !system.solve(vector, solution, 16)) return false;
  // solution: Q<4> levels per Q<10> unit and per Q<4> mm, times 2^16.
  plane.at_origin = shift_round(solution[0], 4 + 16 - 10 - 8);
  plane.slope_x = solution[1];  // Q<4 + 16 - 4>
  plane.slope_y = solution[2];
  return true;
}

std::int32_t clamp_level(std::int64_t v) {
  if (v > kMaxLevel) return kMaxLevel;
  return v < -kMaxLevel ? -kMaxLevel : static_cast<std::int32_t>(v);
}

}  // namespace

void start_levels(int black, int white, int sectors, OutlineLevels& levels) {
  const std::int32_t contrast = white - black < 8 ? 8 : white - black;
  for (int k = 0; k < sectors; ++k) {
    levels.sectors[k] = SectorLevel{};
    levels.sectors[k].black = black << kLevelFraction;
    levels.sectors[k].contrast = contrast << kLevelFraction;
  }
  levels.black = LightPlane{std::int64_t{black} << 8, 0, 0};
  levels.contrast = LightPlane{std::int64_t{contrast} << 8, 0, 0};
}

void update_sector_level(const SectorSums& sums, SectorLevel& level) {
  LevelChange change;
  level.trusted = sums.stations > 0 && 2 * sums.rejected < sums.stations &&
                  solve_levels(sums, sums.pixels, change);
  if (!level.trusted) return;
  level.black = clamp_level(std::int64_t{level.black} + change.black);
  level.contrast = clamp_level(std::int64_t{level.contrast} + change.contrast);
}

void keep_share(const SectorSums& sums, const BlurShare& blur, SectorShare& share) {
  share.step = sums.step;
  share.step_step = sums.step_step;
  share.pixels = sums.pixels;
  for (int i = 0; i < kOutlineUnknowns; ++i) {
    share.by_black[i] = saturate32(sums.by_black[i] >> 14);
    share.by_contrast[i] = saturate32(sums.by_contrast[i] >> 14);
  }
  for (int i = 0; i < 3; ++i) {
    share.blur_by_black[i] = saturate32(blur.by_black[i] >> 4);
    share.blur_by_contrast[i] = saturate32(blur.by_contrast[i] >> 4);
  }
}

void follow_step(const SectorShare& share, const OutlineStep& step, SectorLevel& level) {
  std::int64_t black = 0, contrast = 0;  // Q<34>
  for (int i = 0; i < kOutlineUnknowns; ++i) {
    const auto x = saturate32(step.pose[i]);
    add_product(black, share.by_black[i], x);
    add_product(contrast, share.by_contrast[i], x);
  }
  for (int i = 0; i < 3; ++i) {
    const auto x = saturate32(step.blur[i]);
    add_product(black, share.blur_by_black[i], x);
    add_product(contrast, share.blur_by_contrast[i], x);
  }
  LevelSums sums;
  sums.step = share.step;
  sums.step_step = share.step_step;
  sums.residual = -shift_round(black, 34 - 8);
  sums.step_residual = -shift_round(contrast, 34 - 21);
  LevelChange change;
  if (!level.trusted || !solve_levels(sums, share.pixels, change)) return;
  level.black = clamp_level(std::int64_t{level.black} + change.black);
  level.contrast = clamp_level(std::int64_t{level.contrast} + change.contrast);
}

namespace {

// How far a sector's contrast may lie off the plane: 3 % and its own noise.
std::int64_t tolerance(std::int64_t expected) { return expected / 32 + (1 << kLevelFraction) / 2; }

// Sectors near the plane; returns their number.
int choose_near(const OutlineLevels& levels, int sectors, const LightPlane& plane, bool* use) {
  int count = 0;
  for (int k = 0; k < sectors; ++k) {
    const SectorLevel& s = levels.sectors[k];
    const std::int64_t expected = plane.at(s.x, s.y) >> 4;
    const std::int64_t off = s.contrast - expected;
    use[k] =
        s.trusted && s.contrast >= kMinContrast && (off < 0 ? -off : off) < tolerance(expected);
    count += use[k] ? 1 : 0;
  }
  return count;
}

// Plane through the contrasts of three sectors, by Cramer's rule; false where they are collinear.
bool plane_through(const SectorLevel& a, const SectorLevel& b, const SectorLevel& c,
                   LightPlane& plane) {
  // mm Q<4>, below 2^13: products below 2^27; contrasts Q<4>, below 2^13.
  const std::int64_t x1 = (b.x.raw() - a.x.raw()) >> 14, y1 = (b.y.raw() - a.y.raw()) >> 14;
  const std::int64_t x2 = (c.x.raw() - a.x.raw()) >> 14, y2 = (c.y.raw() - a.y.raw()) >> 14;
  const std::int64_t c1 = b.contrast - a.contrast, c2 = c.contrast - a.contrast;
  const std::int64_t determinant = x1 * y2 - x2 * y1;
  const std::int64_t least = x1 * x1 + y1 * y1 + x2 * x2 + y2 * y2;
  if (8 * static_cast<std::int64_t>(magnitude(determinant)) <= least) return false;
  plane.slope_x = ((c1 * y2 - c2 * y1) * (1 << 16)) / determinant;
  plane.slope_y = ((c2 * x1 - c1 * x2) * (1 << 16)) / determinant;
  plane.at_origin = 0;
  plane.at_origin = a.contrast * 16 - plane.at(a.x, a.y);
  return true;
}

// The plane that most sectors agree on, from triples spread over the target (Fischler, Bolles 1981,
// with a fixed sequence): a shadow's edge splits the sectors in two and would tilt a mean. That of
// seven eighths of the `sound` ones is taken as soon as it is met.
bool find_plane(const OutlineLevels& levels, int sectors, int sound, LightPlane& best) {
  int most = 0;
  bool use[kMaxSectors] = {};
  std::uint32_t state = 1;
  for (int trial = 0; trial < kTriples && 8 * most < 7 * sound; ++trial) {
    const SectorLevel* triple[3];
    bool is_sound = true;
    for (const SectorLevel*& s : triple) {
      state = state * 1664525u + 1013904223u;
      s = &levels.sectors[((state >> 16) * static_cast<std::uint32_t>(sectors)) >> 16];
      is_sound = is_sound && s->trusted && s->contrast >= kMinContrast;
    }
    LightPlane plane;
    if (!is_sound || !plane_through(*triple[0], *triple[1], *triple[2], plane)) continue;
    const int count = choose_near(levels, sectors, plane, use);
    if (count > most) {
      most = count;
      best = plane;
    }
  }
  return most >= 6;
}

}  // namespace

void fit_light(int sectors, OutlineLevels& levels) {
  LightPlane contrast = levels.contrast, black = levels.black;
  bool use[kMaxSectors] = {};
  int sound = 0;
  for (int k = 0; k < sectors; ++k) {
    use[k] = levels.sectors[k].trusted && levels.sectors[k].contrast >= kMinContrast;
    sound += use[k] ? 1 : 0;
  }
  // One plane for all, or, where that leaves some out, the one of most.
  bool found = fit_plane(levels, sectors, use, true, contrast);
  if (found && choose_near(levels, sectors, contrast, use) < sound) {
    found = find_plane(levels, sectors, sound, contrast);
    for (int i = 0; found && i < kRefits; ++i) {
      choose_near(levels, sectors, contrast, use);
      found = fit_plane(levels, sectors, use, true, contrast);
    }
  }
  if (found) {
    choose_near(levels, sectors, contrast, use);
    fit_plane(levels, sectors, use, false, black);
  }
  levels.contrast = contrast;
  levels.black = black;
  for (int k = 0; k < sectors; ++k) {
    SectorLevel& s = levels.sectors[k];
    if (s.trusted) continue;
    s.contrast = clamp_level(contrast.at(s.x, s.y) >> 4);
    s.black = clamp_level(black.at(s.x, s.y) >> 4);
    if (s.contrast < 2 * kMinContrast) s.contrast = 2 * kMinContrast;
  }
}

SectorLight light_of(const OutlineLevels& levels, int sector, Unit nearer) {
  const SectorLevel& s = levels.sectors[sector];
  // Slopes of the plane, scaled by the sector's contrast over the plane's there.
  std::int64_t here = levels.contrast.at(s.x, s.y) >> 4;
  if (here < kMinContrast) here = kMinContrast;
  std::int64_t ratio = (std::int64_t{s.contrast} * (1 << 14)) / here;  // Q<14>
  if (ratio > 2 << 14) ratio = 2 << 14;
  if (ratio < 0) ratio = 0;
  ratio += shift_round(ratio * nearer.raw(), 30);
  const auto scaled = [&](std::int64_t slope) {
    return saturate32(shift_round(slope * ratio, 14));
  };
  return {s.x,
          s.y,
          s.black,
          s.contrast,
          {scaled(levels.black.slope_x), scaled(levels.black.slope_y)},
          {scaled(levels.contrast.slope_x), scaled(levels.contrast.slope_y)}};
}

LocalLevel level_at(const SectorLight& light, Mm x, Mm y) {
  const std::int32_t dx = (x - light.x).raw(), dy = (y - light.y).raw();
  const auto rise = [&](const std::int32_t slope[2]) {
    return shift_round(std::int64_t{slope[0]} * dx + std::int64_t{slope[1]} * dy,
                       16 + 18 - kLevelFraction);
  };
  return {clamp_level(light.black + rise(light.black_slope)),
          clamp_level(light.contrast + rise(light.contrast_slope))};
}

bool shows_marker(const OutlineLevels& levels, int sector) {
  const SectorLevel& s = levels.sectors[sector];
  const std::int64_t expected = levels.contrast.at(s.x, s.y) >> 4;
  return s.contrast >= kMinContrast && 7 * std::int64_t{s.contrast} > expected;
}

}  // namespace berth
