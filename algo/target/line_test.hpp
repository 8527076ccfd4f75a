// The line test: are there two parallel straight edges where the bar's long sides should be?
#pragma once

#include "target/reference.hpp"

namespace berth {

struct LineTest {
  bool is_line = false;   // straight, ends where it should, near its place
  bool in_place = false;  // and within half its width of it
  int stations = 0;       // of kLineStations, at which both long edges show
  Angle turn;             // roll to add so that the bar lies straight
  Mm offset_mm;           // of the bar's axis from its place, outwards
  int cost = 0;   // |offset| in 1/256 of the bar's width, less 64 per station: lower is better
  int looks = 0;  // at stations, in all tests
};

/// Profiles across the bar at nine stations. `view` has the roll of the search. Levels are judged
/// against the bar's own surroundings, since it may lie in a shadow. The profiles are centred
/// `shift_mm` further out than the bar's place, and see a bar up to half a width from there.
/// Less than `least_stations` (at least 3) with a bar make no line, and the rest is not looked at.
/// Cost: at most 180 samples, 21 k instructions; 8 k where there is no bar.
LineTest test_line(const TargetView& view, const TargetModel& target,
                   const ReferenceValues& reference, std::uint16_t noise_q8, Mm shift_mm = Mm(0),
                   int least_stations = 3);

/// The line near its place: where it is not seen at once, 0.6 widths further in and out, since the
/// pose of a blurred or cut ring may be off by as much.
LineTest find_line(const TargetView& view, const TargetModel& target,
                   const ReferenceValues& reference, std::uint16_t noise_q8);

}  // namespace berth
