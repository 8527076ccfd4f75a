// One Gauss-Newton step from the sectors of a round.
#pragma once

#include "pose/outline_round.hpp"

namespace berth {

/// Sums the sectors that are used, all alike, into the normal equations, with the edge offset's
/// prior. Cost: about 800 instructions a sector.
void sum_sectors(OutlineState& state);

/// Factors the equations; false where they determine no pose.
bool factor_equations(OutlineState& state);

/// Solves for the step and takes it; where the round judges, sectors that are further off than
/// noise would have it weigh less. False where the outlines do not determine a pose.
bool take_step(OutlineState& state, const OutlineRound& round);

}  // namespace berth
