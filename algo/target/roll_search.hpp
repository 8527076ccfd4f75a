// The roll of a plate: grey levels on circles about the ring's centre against the layout.
#pragma once

#include "target/reference.hpp"

namespace berth {

struct RollScore {
  Angle angle;    // of the target's x axis from the plate's u axis, towards v
  int score = 0;  // mean of the expected white less mean of the expected black, -256..256
};

/// Best of 72 rolls. `view` has roll 0. Cost: about 72 samples for each distinct distance of line
/// and dots from the centre, 55 k instructions in all for CT-1.
RollScore search_roll(const TargetView& view, const TargetModel& target,
                      const ReferenceValues& reference);

}  // namespace berth
