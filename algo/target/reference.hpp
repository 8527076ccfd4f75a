// Stage 4: reference values, the grey levels of this target's white and black in this light.
//
// White is read in the middle of the ring, black on the plate around it, each in sectors, since
// light may fall off 4 : 1 over the plate and shadows may cross it. A sector that shows too little
// contrast (hidden, under the collar, in shadow) borrows the medians of all. They serve the line
// test and the layout check as well, so they are taken as soon as there is a ring.
#pragma once

#include "target/model.hpp"
#include "target/sampling.hpp"

namespace berth {

constexpr int kReferenceSectors = 24;

struct ReferenceValues {
  Grey white = 0, black = 0;             // medians over the sectors
  Grey sector_white[kReferenceSectors];  // by angle from the plate's x (roll not yet known) axis
  Grey sector_black[kReferenceSectors];
  int bright_sectors = 0;   // ring brighter than the plate outside it
  int hollow_sectors = 0;   // ring brighter than the plate inside it
  int clipped_sectors = 0;  // white at 255
};

/// Reads ring and plate. `view` may have any roll. Cost: about 72 samples, 21 k instructions.
ReferenceValues measure_reference(const TargetView& view, const TargetModel& target);

/// Grey level relative to the references of its sector: 0 black, 256 white, clamped to -128..384.
int relative_level(const ReferenceValues& reference, int sector, Grey grey);

}  // namespace berth
