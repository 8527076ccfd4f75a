// Which cells of a row are local maxima of the gradient magnitude: two cells at a time.
//
// A cell is on a ridge when it is a maximum along the gradient's dominant axis; where both axes are
// nearly equal (|gx| and |gy| within 5 : 3), along either of them, so that a ridge has no gap where
// its direction turns through 45 degrees. Ties go to the first of two equal neighbours.
#pragma once

#include <cstdint>

#include "image/gradient_rows.hpp"

namespace berth {

/// Words of row `y` whose lane 0 or 1 is on a ridge of at least `threshold`, ascending.
struct Ridges {
  std::uint16_t words[2][kMaxRowWords];
  int count[2];
};

/// Searches the strong words of row y (rows.strong(y)) from word kGridBorder on, with the gradients
/// of rows y - 1 to y + 1 at hand. `words` is the row's layout's. Cost: about 30 instructions per
/// strong word.
void find_ridges(const GradientRows& rows, int y, int words, int threshold, Ridges& ridges);

}  // namespace berth
