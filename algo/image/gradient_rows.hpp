// Smoothed gradient of the search grid on line buffers.
//
// Each cell is the sum of its pixels scaled to 4 x DN (0..1020). The gradient is that of the image
// smoothed by the binomial [1 4 6 4 1] across and [1 2 1] along the derivative, with the central
// difference: kernels [1 4 6 4 1] and [-1 -2 0 2 1], a Sobel operator on a binomially smoothed
// image. Output unit: 128 = 1 DN per cell. Ranges: cells 0..1020, column sums 0..4080 (after a
// rounding shift by 2), column differences -765..765 (same), gradients -12240..12240: every
// intermediate fits 16 bits, and two columns are worked on at a time, as the lanes of a 32-bit
// word; lanes that may be negative carry a bias, so that no borrow crosses them. Cost: about 45
// instructions per cell. Every pixel is read once, in order.
#pragma once

#include <cstdint>

#include "image/search_grid.hpp"
#include "image/view.hpp"

namespace berth {

constexpr int kMaxGridSide = 1024;
constexpr int kGradientUnit = 128;  // gradient of 1 DN per cell

/// Gradient of one grid row; the outermost 2 columns hold 0.
struct GradientRow {
  std::int16_t gx[kMaxGridSide];
  std::int16_t gy[kMaxGridSide];
  std::int16_t magnitude[kMaxGridSide];  // |gx| + |gy|, 0..24480
};

/// Line buffers: 5 rows of cells, the column sums of the row in work, 3 rows of gradients.
struct GradientRows {
  std::uint16_t cells[5][kMaxGridSide];
  std::uint16_t smooth[kMaxGridSide];  // [1 4 6 4 1] down the column, / 4
  std::uint16_t slope[kMaxGridSide];   // [-1 -2 0 2 1] down the column, / 4, + 1024
  GradientRow gradients[3];

  const GradientRow& row(int y) const { return gradients[y % 3]; }
};

/// Bin grid row `y` into its line buffer. 0 <= y < grid.height.
void bin_row(const ImageView& image, const SearchGrid& grid, int y, GradientRows& rows);

/// Gradient of grid row `y` from cells y - 2 .. y + 2, which must have been binned.
void differentiate_row(const SearchGrid& grid, int y, GradientRows& rows);

}  // namespace berth
