// Profiles across ring, line and dots, and what many of them say about a size.
//
// A profile has 25 samples: black is the mean of the outer three of each side, the middle's level
// that of the inner five. Strength is the sum of levels over black, across a diameter each weighted
// by its way from the middle; strength over the middle's level is the width of a band, or r^2.
#pragma once

#include "target/reference.hpp"

namespace berth {

constexpr int kReach = 12, kSamples = 2 * kReach + 1, kInner = 9, kMiddle = 2;
constexpr int kBandSteps = 8, kDotSteps = 6;  // samples in a band's width, in a dot's radius
constexpr int kBandNominal = 16 * kBandSteps, kDotNominal = 16 * kDotSteps * kDotSteps;
constexpr int kMaxSites = 6 * kMaxDots;

constexpr int kOne = 4096;  // ratios have 12 bits

/// length numerator / denominator, towards zero.
Mm fraction_of(Mm length, std::int32_t numerator, std::int32_t denominator);

// A profile's place: its middle, and the way to 16 samples farther on. Where `aside` is not zero,
// the profile is the mean of three: those that far to both sides are read as well.
struct Track {
  Mm x, y, dx, dy;
  Mm aside_x, aside_y;
};

/// Levels along a track, shifted by `phase` sixteenths of a sample; false where it leaves the
/// image. Cost: 3 projections and 25 samples, 2500 instructions.
bool read_profile(const TargetView& view, const Track& track, int phase, Grey (&level)[kSamples]);

/// Three times the level before and after what the profile crosses.
inline Grey before_of(const Grey (&level)[kSamples]) { return level[0] + level[1] + level[2]; }
inline Grey after_of(const Grey (&level)[kSamples]) {
  return level[kSamples - 1] + level[kSamples - 2] + level[kSamples - 3];
}

struct Site {
  std::int32_t index = 0;     // among the profiles that were tried
  std::int32_t strength = 0;  // sum of level over black, times 16 or the distance in 1/16 steps
  std::int32_t contrast = 0;  // of the middle
  std::int32_t lit = 0;       // that of the light there, where it is known
  std::int64_t energy = 0;    // the same sum of squares
  std::int32_t sides = 0;     // difference of black on both sides
  std::int32_t lean = 0;      // of the middle: level after it less that before it, twice
};

struct Sites {
  int count = 0;
  int first_half = 0;  // of the count, where halves are judged apart
  Site site[kMaxSites];
};

/// Contrast as a plane over the target, from the strengths of its flat dots.
struct Light {
  bool is_known = false;
  std::int64_t plane[3] = {};  // Grey per 1/1024, per mm/16 in x and y; 16 bits

  static void row_at(Mm x, Mm y, std::int64_t (&row)[3]) {
    row[0] = 1 << 10;  // about the size of the others, for the condition
    row[1] = x.raw() >> 14;
    row[2] = y.raw() >> 14;
  }
  Grey at(Mm x, Mm y) const {
    std::int64_t row[3];
    row_at(x, y, row);
    return saturate32(shift_round(plane[0] * row[0] + plane[1] * row[1] + plane[2] * row[2], 16));
  }
};

/// From the contrast of each dot, 0 where it is not known. Known where four dots or more fit a
/// plane to 4 %: a shadow or a glint on one spoils it.
Light fit_light(const TargetModel& target, const Grey (&contrast)[kMaxDots]);

/// Where profiles are read, and what is expected there.
struct Eye {
  const TargetView& view;
  const TargetModel& target;
  Grey contrast, noise;
  Light light;
  Grey least() const { return contrast / 8 > 2 * noise ? contrast / 8 : 2 * noise; }
  std::int64_t noise_energy(int weights) const {  // interpolation halves the variance
    return std::int64_t{noise} * noise * weights / 2;
  }
};

/// Exchanges the contrast of the middle and that of the light, which blur leaves alone. False
/// where the light has none at a site, and then nothing is exchanged.
bool exchange_light(Sites& sites);

/// Reads a profile and adds it where it shows contrast. `index` chooses its phase: sharp edges then
/// meet all phases of the samples.
void add_site(const Eye& eye, const Track& track, int index, bool is_diameter, Sites& sites);

struct Size {
  bool is_known = false;
  int ratio = 0, sigma = 0;  // to the description's, 12 bits
  int rho = 0;
  int lean = 0;  // of the middle, to its level, 12 bits
};

/// Median of strength over contrast of sites first .. end - 1, in 1/64.
std::int32_t median_ratio(const Sites& sites, int first, int end);

/// Is a site's ratio a fifth off the typical one (in 1/64)?
bool is_outlier(const Site& s, std::int64_t typical);

/// Sums over all sites near the typical ratio; sigma from their scatter. `nominal`: strength per
/// contrast of the description. Unknown where fewer than `least_sites` remain.
Size summarize(const Sites& sites, int nominal, int least_sites, std::int64_t noise_energy);

}  // namespace berth
