// Region growing of one bright marker in a window of the frame.
//
// From a seed, rows are added up and down as long as a run of pixels above the threshold overlaps
// the run of the row before (the markers are convex: one run per row). A region that reaches the
// window's border has merged with something else.
#pragma once

#include <cstdint>

#include "image/view.hpp"

namespace berth {

constexpr int kMaxRegionRows = 256;

struct Window {
  int x0, y0, x1, y1;  // inclusive, inside the image
};

struct Region {
  bool touches_border = false;
  int area = 0;                        // pixels above the threshold
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // bounding box, inclusive
};

/// What counts as bright: a pixel's level above `threshold` (DN), or the mean of its 3 x 3 where
/// noise would tear the region apart.
struct GrowRule {
  int threshold = 0;
  bool smooth = false;
};

/// Grow from (x, y), which must be bright. Bounded by the window. Cost: about 6 instructions per
/// pixel of the region's bounding box, 25 when smooth.
Region grow_region(const ImageView& image, const Window& window, int x, int y, GrowRule rule);

}  // namespace berth
