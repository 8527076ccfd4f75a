// The line's width against the ring's, where the ring runs as the line does.
//
// What blur, motion, tilt, gamma and clipping make of a band depends on its width and on its
// direction on the plate. A ring as wide as the line shows the line's own profile there, whatever
// the light and the camera, so that no model of them is needed. Over the ring's profiles
//
//   size = a + b cos 2x + c sin 2x,   x: angle from the line's normal
//
// by least squares; a + b is compared with the line's size.
#pragma once

#include "target/verify_profiles.hpp"
#include "target/verify_sizes.hpp"

namespace berth {

/// What is left of a band's level in its middle, 12 bits, where blur takes a part of it.
struct BandLevels {
  int ring = kOne, line = kOne;
};

/// `ring`: sites with `index` counting from the x axis, `directions` to the turn. `line` from
/// summarize(), `noise` that of a pixel. Unknown where too few of the ring's sites remain. Cost:
/// about 15 k instructions.
SizeRatio compare_widths(const TargetModel& target, const Sites& ring, int directions,
                         const Size& line, const BandLevels& left, Grey noise);

}  // namespace berth
