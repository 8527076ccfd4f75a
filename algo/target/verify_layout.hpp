// The layout check with a good pose: are ring and line where the dots say they are?
//
// Stage 3 accepts what fits the plate pose of a ring, which is only right to a few per cent. Once
// the dots have given a pose to a fraction of a pixel, a target of other proportions shows: its
// ring has another size than the dots' distance predicts, its line another place, or ring, line and
// dots another width (verify_sizes.hpp).
#pragma once

#include "circle/ring_candidates.hpp"
#include "image/search_grid.hpp"
#include "target/line_test.hpp"

namespace berth {

struct LayoutCheck {
  bool is_consistent = false;
  Mm sigma_mm{0};  // of the blur, as the dots show it; 0: unknown
};

/// Does the outline of `ring` have the size the pose in `view` predicts, to 5 % and 0.8 px?
bool is_ring_of_size(const TargetView& view, const TargetModel& target, const SearchGrid& grid,
                     const RingCandidate& ring);

/// Does the line lie within 0.37 of its width and 4 degrees of its place, and are the sizes the
/// model's? Cost: about 300 k instructions.
LayoutCheck check_layout(const TargetView& view, const TargetModel& target,
                         const ReferenceValues& reference, std::uint16_t noise_q8);

}  // namespace berth
