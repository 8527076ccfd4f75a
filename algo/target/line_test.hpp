// The line test: are there two parallel straight edges where the bar's long sides should be?
#pragma once

#include "target/reference.hpp"

namespace berth {

struct LineTest {
  bool is_line = false;
  int stations = 0;  // of kLineStations, at which both long edges show
  Angle turn;        // roll to add so that the bar lies straight
  Mm offset_mm;      // of the bar's axis from its place, outwards
  int cost = 0;      // |offset| in 1/256 of the bar's width, less 64 per station: lower is better
};

/// Profiles across the bar at nine stations. `view` has the roll of the search. Levels are judged
/// against the bar's own surroundings, since it may lie in a shadow. Cost: about 180 samples, 35 k
/// instructions.
LineTest test_line(const TargetView& view, const TargetModel& target,
                   const ReferenceValues& reference, std::uint16_t noise_q8);

}  // namespace berth
