// Edge pixels of a frame as sparse rows: what 384 KiB can hold instead of a gradient map.
//
// Pixels stand in raster order. Each row is cut into 8 blocks of equal width and `block_start`
// gives the first pixel of each, so that a neighbour is found by looking at two or three entries.
#pragma once

#include <cstdint>

#include "core/span.hpp"
#include "image/gradient_rows.hpp"

namespace berth {

/// One edge pixel, 8 bytes.
struct EdgePixel {
  std::uint16_t x_and_offset;  // grid column << 6 | (sub-cell offset + 32) in 1/64 cell
  std::int16_t gx, gy;         // gradient, kGradientUnit = 1 DN per cell
  // Second derivative along the isophote, 128 = 1 DN per cell^2. Stage 2 overwrites it on chains
  // with the isophote's radius there: cells, positive for bright inside, 0 for straight.
  std::int16_t lvv;

  int x() const { return x_and_offset >> 6; }
  /// Offset of the edge from the pixel's centre along the gradient's dominant axis, 1/64 cell.
  int offset() const { return (x_and_offset & 63) - 32; }
  int isophote_radius() const { return lvv; }  // after stage 2
  int magnitude() const { return (gx < 0 ? -gx : gx) + (gy < 0 ? -gy : gy); }
  bool is_steep_in_x() const { return (gx < 0 ? -gx : gx) >= (gy < 0 ? -gy : gy); }
};

static_assert(sizeof(EdgePixel) == 8);

constexpr int kBlocksPerRow = 8;
constexpr int kNoEdge = -1;

struct EdgeMap {
  Span<EdgePixel> pixels;           // storage, at most 65535
  Span<std::uint16_t> block_start;  // grid rows * 8 + 1 entries
  int count = 0;
  int width = 0, height = 0;  // of the grid
  int block_shift = 6;        // block = x >> block_shift

  int block_index(int x, int y) const { return y * kBlocksPerRow + (x >> block_shift); }
  int row_begin(int y) const { return block_start[static_cast<std::size_t>(y * kBlocksPerRow)]; }
  int row_end(int y) const {
    return block_start[static_cast<std::size_t>((y + 1) * kBlocksPerRow)];
  }
  const EdgePixel& operator[](int i) const { return pixels[static_cast<std::size_t>(i)]; }

  /// Index of the edge pixel at grid cell (x, y), or kNoEdge. Cost: about 25 instructions.
  int find(int x, int y) const {
    if (x < 0 || y < 0 || x >= width || y >= height) return kNoEdge;
    const std::size_t block = static_cast<std::size_t>(block_index(x, y));
    for (int i = block_start[block]; i < block_start[block + 1]; ++i) {
      const int column = (*this)[i].x();
      if (column >= x) return column == x ? i : kNoEdge;
    }
    return kNoEdge;
  }
};

}  // namespace berth
