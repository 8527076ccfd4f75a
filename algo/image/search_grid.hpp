// The grid on which edges are searched: a region of the frame, binned by 1, 2 or 4.
//
// A cell (i, j) of the grid covers pixels x0 + bin i .. x0 + bin i + bin - 1, so its centre lies at
// x0 + bin i + (bin - 1) / 2 (likewise y).
#pragma once

#include "fixed/q.hpp"
#include "image/view.hpp"

namespace berth {

struct SearchGrid {
  int x0 = 0, y0 = 0;         // first pixel of the region
  int bin = 2;                // 1, 2 or 4 pixels per cell and axis
  int width = 0, height = 0;  // cells

  /// Frame coordinates of a grid coordinate (Q<16> cells to Q<16> pixels).
  Px to_frame_x(Px i) const { return Px::from_raw(i.raw() * bin + ((bin - 1) << 15) + (x0 << 16)); }
  Px to_frame_y(Px j) const { return Px::from_raw(j.raw() * bin + ((bin - 1) << 15) + (y0 << 16)); }
};

/// The whole frame, binned 2 x 2; an odd last row or column is left out.
inline SearchGrid whole_frame(const ImageView& image) {
  return SearchGrid{0, 0, 2, image.width / 2, image.height / 2};
}

/// The region of a grid binned 2 x 2, binned 4 x 4.
inline SearchGrid coarser(const SearchGrid& fine) {
  return SearchGrid{fine.x0, fine.y0, 4, fine.width / 2, fine.height / 2};
}
inline bool is_coarse(const SearchGrid& grid) { return grid.bin == 4; }

}  // namespace berth
