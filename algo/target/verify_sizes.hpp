// The layout check's last question: are ring, line and dots as wide and as long as the target's?
//
// Asked with the pose from the dots, of profiles (verify_profiles.hpp). With v the level over black
// and c that of the middle,
//   size = sum v / c                         width of a band; of a dot, over diameters, r^2 by |s|
//   v rho  = 1 - sum |s| v^2 / (c sum |s| v)   of the dots: their blur, sigma / r = 0.89 rho
// Sums run over all profiles, so that light may differ between them; one crossed by a shadow's
// edge, a glint or the collar is an outlier of the median and left out. Blur takes a part of a
// narrow band's middle: its size is corrected by the dots' sigma. Where sigma exceeds a fifth of
// the ring's width, c is a plane through the dots' strengths instead, which blur leaves alone, if
// dots and ring agree that light is even.
//
// Gamma, clipping and exposure move all edges outwards by one offset, up to 3 sigma. A
// target is refused where no such offset explains the sizes within 2 % of a band's width, 1 % of a
// dot's radius and two sigma of the measured scatter, each. What cannot be measured refutes
// nothing.
#pragma once

#include "target/reference.hpp"

namespace berth {

/// By how much a size lies off the description: edges outwards, in mm on the plate.
struct EdgeShift {
  bool is_known = false;
  Mm shift_mm;      // of each edge
  Mm tolerance_mm;  // of noise, blur and light
};

/// A size relative to another, 12 bits, less 1.
struct SizeRatio {
  bool is_known = false;
  int off = 0, tolerance = 0;
};

struct Sizes {
  EdgeShift ring, dots;
  SizeRatio line_to_ring;
  EdgeShift line_end;  // the lesser fault of its two ends, if both are off the same way
  Mm sigma_mm;         // of the blur
};

/// `view` has the pose from the dots. Cost: about 2000 samples, 250 k instructions.
Sizes measure_sizes(const TargetView& view, const TargetModel& target,
                    const ReferenceValues& reference, std::uint16_t noise_q8);

/// Is there an edge offset that explains all sizes?
bool are_sizes_consistent(const Sizes& sizes);

}  // namespace berth
