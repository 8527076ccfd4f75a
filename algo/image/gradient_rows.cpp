#include "image/gradient_rows.hpp"

namespace berth {
namespace {

void bin_row_pairs(const std::uint8_t* top, const std::uint8_t* bottom, int mask, int width,
                   std::uint16_t* cells) {
  for (int i = 0; i < width; ++i) {
    cells[i] = static_cast<std::uint16_t>((top[2 * i] ^ mask) + (top[2 * i + 1] ^ mask) +
                                          (bottom[2 * i] ^ mask) + (bottom[2 * i + 1] ^ mask));
  }
}

struct ColumnSums {
  int smooth, slope;
};

// Vertical parts of both kernels at column x; rounding shifts keep all in 16 bits.
inline ColumnSums column(const std::uint16_t* const r[5], int x) {
  const int smooth = r[0][x] + 4 * r[1][x] + 6 * r[2][x] + 4 * r[3][x] + r[4][x];
  const int slope = (r[4][x] - r[0][x]) + 2 * (r[3][x] - r[1][x]);
  return {(smooth + 2) >> 2, (slope + 2) >> 2};
}

}  // namespace

void bin_row(const ImageView& image, const SearchGrid& grid, int y, GradientRows& rows) {
  std::uint16_t* cells = rows.cells[y % 5];
  const int mask = image.polarity_mask;
  if (grid.bin == 2) {
    const std::uint8_t* top = image.row(grid.y0 + 2 * y) + grid.x0;
    bin_row_pairs(top, top + image.stride, mask, grid.width, cells);
    return;
  }
  const std::uint8_t* row = image.row(grid.y0 + y) + grid.x0;
  for (int i = 0; i < grid.width; ++i) cells[i] = static_cast<std::uint16_t>((row[i] ^ mask) * 4);
}

void differentiate_row(const SearchGrid& grid, int y, GradientRows& rows) {
  BERTH_RANGE(y >= 2 && y + 2 < grid.height && grid.width >= 8);
  const std::uint16_t* r[5];
  for (int k = 0; k < 5; ++k) r[k] = rows.cells[(y - 2 + k) % 5];
  GradientRow& out = rows.gradients[y % 3];
  const int last = grid.width - 1;
  const int outermost[4] = {0, 1, last - 1, last};
  for (const int x : outermost) out.gx[x] = out.gy[x] = out.magnitude[x] = 0;

  ColumnSums a = column(r, 0), b = column(r, 1), c = column(r, 2), d = column(r, 3);
  for (int x = 2; x < grid.width - 2; ++x) {
    const ColumnSums e = column(r, x + 2);
    const int gx = (e.smooth - a.smooth) + 2 * (d.smooth - b.smooth);
    const int gy = a.slope + 4 * b.slope + 6 * c.slope + 4 * d.slope + e.slope;
    out.gx[x] = narrow<std::int16_t>(gx);
    out.gy[x] = narrow<std::int16_t>(gy);
    out.magnitude[x] = narrow<std::int16_t>((gx < 0 ? -gx : gx) + (gy < 0 ? -gy : gy));
    a = b;
    b = c;
    c = d;
    d = e;
  }
}

}  // namespace berth
