// Grey levels of each sector, and the slope of the light across the target.
//
// Levels are a sector's own; their slope inside a sector comes from a plane through the contrasts
// of all sectors, since a free slope would cost a small dot half of what it knows about its place.
// In a shadow the slope shrinks with the contrast: it is the relative slope that is common.
#pragma once

#include <cstdint>

#include "pose/outline_blur.hpp"
#include "pose/outline_layout.hpp"
#include "pose/outline_normal.hpp"

namespace berth {

struct SectorLevel {
  Mm x, y;                               // centre
  std::int32_t black = 0, contrast = 0;  // DN, Q<4>
  bool trusted = false;                  // measured on enough undisturbed stations
};

/// value = at_origin + (slope_x x + slope_y y), DN: Q<8>; slopes DN per mm Q<16>.
struct LightPlane {
  std::int64_t at_origin = 0, slope_x = 0, slope_y = 0;
  std::int64_t at(Mm x, Mm y) const {
    return at_origin + shift_round(slope_x * x.raw() + slope_y * y.raw(), 26);
  }
};

struct OutlineLevels {
  SectorLevel sectors[kMaxSectors];
  LightPlane black, contrast;
};

/// All sectors at the same levels, DN.
void start_levels(int black, int white, int sectors, OutlineLevels& levels);

/// Takes over what a sector's sums say; untrusted where most of it was rejected.
void update_sector_level(const SectorSums& sums, SectorLevel& level);

/// What of a sector its levels share with the other unknowns, as far as a step needs it.
struct SectorShare {
  std::int64_t step, step_step, pixels;                                    // of the LevelSums
  std::int32_t by_black[kOutlineUnknowns], by_contrast[kOutlineUnknowns];  // Q<4>
  std::int32_t blur_by_black[3], blur_by_contrast[3];                      // Q<18>
};
void keep_share(const SectorSums& sums, const BlurShare& blur, SectorShare& share);

/// A step of all unknowns but the levels.
struct OutlineStep {
  std::int64_t pose[kOutlineUnknowns] = {};  // Q<30>
  std::int64_t blur[3] = {};                 // xx, xy, yy, px^2 Q<16>
};

/// Levels were updated as if the other unknowns stayed where they are: what their step takes of it.
void follow_step(const SectorShare& share, const OutlineStep& step, SectorLevel& level);

/// Planes through the trusted sectors, outliers left out; untrusted sectors get the plane's levels.
void fit_light(int sectors, OutlineLevels& levels);

/// Light inside one sector, linear about its centre.
struct SectorLight {
  Mm x, y;                                         // centre
  std::int32_t black, contrast;                    // there, DN Q<4>
  std::int32_t black_slope[2], contrast_slope[2];  // DN per mm, Q<16>
};

/// `nearer`: how much larger the marker's scale in the image is than the plate's, minus one. Light
/// that falls off in the image (vignetting) falls off per pixel; that of a near lamp lies between.
SectorLight light_of(const OutlineLevels& levels, int sector, Unit nearer);

/// Levels at a place, DN Q<4>.
struct LocalLevel {
  std::int32_t black, contrast;
};
LocalLevel level_at(const SectorLight& light, Mm x, Mm y);

/// Whether the sector shows a marker: contrast of at least a seventh of the plane's, and 4 DN.
bool shows_marker(const OutlineLevels& levels, int sector);

}  // namespace berth
