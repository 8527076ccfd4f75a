#include "image/gradient_rows.hpp"

#include <cstring>

namespace berth {
namespace {

// Two 16-bit numbers in one word, the first in the lower half (little-endian, as they lie in
// memory).
using Pair = std::uint32_t;

constexpr Pair both(std::uint32_t value) { return value << 16 | value; }

Pair load(const void* from) {
  Pair pair;
  std::memcpy(&pair, from, sizeof pair);
  return pair;
}

void store(void* to, Pair pair) { std::memcpy(to, &pair, sizeof pair); }

// Sums of horizontally neighbouring bytes: four pixels to two lanes.
constexpr Pair add_neighbours(std::uint32_t pixels) {
  return (pixels & 0x00ff00ffu) + (pixels >> 8 & 0x00ff00ffu);
}

void bin_row_pairs(const std::uint8_t* top, const std::uint8_t* bottom, std::uint8_t mask,
                   int width, std::uint16_t* cells) {
  const std::uint32_t flip = mask * 0x01010101u;
  int i = 0;
  for (; i + 2 <= width; i += 2) {
    store(cells + i,
          add_neighbours(load(top + 2 * i) ^ flip) + add_neighbours(load(bottom + 2 * i) ^ flip));
  }
  for (; i < width; ++i) {
    cells[i] = static_cast<std::uint16_t>((top[2 * i] ^ mask) + (top[2 * i + 1] ^ mask) +
                                          (bottom[2 * i] ^ mask) + (bottom[2 * i + 1] ^ mask));
  }
}

// Vertical parts of both kernels, two columns at a time. Lanes: smooth 0..16320; slope -3060..3060,
// biased by 4096 to stay positive; both rounded and divided by 4.
void sum_columns(const std::uint16_t* const (&r)[5], int width, GradientRows& rows) {
  for (int x = 0; x < width; x += 2) {
    const Pair a = load(r[0] + x), b = load(r[1] + x), c = load(r[2] + x), d = load(r[3] + x),
               e = load(r[4] + x);
    const Pair smooth = a + e + 4 * (b + d) + 6 * c;
    const Pair slope = e + 2 * d + both(4096) - a - 2 * b;
    store(rows.smooth + x, (smooth + both(2)) >> 2 & both(0x3fff));
    store(rows.slope + x, (slope + both(2)) >> 2 & both(0x3fff));
  }
}

constexpr int kBiasX = 16384;
constexpr int kBiasY = 16 * 1024;  // 1024 per column, weights 1 + 4 + 6 + 4 + 1

void put(int gx, int gy, int x, GradientRow& out) {
  BERTH_RANGE(gx >= -12240 && gx <= 12240 && gy >= -12240 && gy <= 12240);
  out.gx[x] = static_cast<std::int16_t>(gx);
  out.gy[x] = static_cast<std::int16_t>(gy);
  out.magnitude[x] = static_cast<std::int16_t>((gx < 0 ? -gx : gx) + (gy < 0 ? -gy : gy));
}

}  // namespace

void bin_row(const ImageView& image, const SearchGrid& grid, int y, GradientRows& rows) {
  std::uint16_t* cells = rows.cells[y % 5];
  const std::uint8_t mask = image.polarity_mask;
  if (grid.bin == 2) {
    const std::uint8_t* top = image.row(grid.y0 + 2 * y) + grid.x0;
    bin_row_pairs(top, top + image.stride, mask, grid.width, cells);
  } else {
    const std::uint8_t* row = image.row(grid.y0 + y) + grid.x0;
    for (int i = 0; i < grid.width; ++i) cells[i] = static_cast<std::uint16_t>((row[i] ^ mask) * 4);
  }
  // An odd row's last pair has a lane beyond it, which no gradient uses but which must be defined.
  if (grid.width % 2 != 0) cells[grid.width] = 0;
}

void differentiate_row(const SearchGrid& grid, int y, GradientRows& rows) {
  BERTH_RANGE(y >= 2 && y + 2 < grid.height && grid.width >= 8);
  const std::uint16_t* r[5];
  for (int k = 0; k < 5; ++k) r[k] = rows.cells[(y - 2 + k) % 5];
  GradientRow& out = rows.gradients[y % 3];
  const int last = grid.width - 1;
  const int outermost[4] = {0, 1, last - 1, last};
  for (const int x : outermost) out.gx[x] = out.gy[x] = out.magnitude[x] = 0;
  sum_columns(r, grid.width, rows);

  const std::uint16_t *m = rows.smooth, *s = rows.slope;
  int x = 2;
  for (; x + 1 < last - 1; x += 2) {
    const Pair gx = load(m + x + 2) + 2 * load(m + x + 1) + both(kBiasX) - load(m + x - 2) -
                    2 * load(m + x - 1);
    const Pair gy = load(s + x - 2) + load(s + x + 2) + 4 * (load(s + x - 1) + load(s + x + 1)) +
                    6 * load(s + x);
    put(static_cast<int>(gx & 0xffff) - kBiasX, static_cast<int>(gy & 0xffff) - kBiasY, x, out);
    put(static_cast<int>(gx >> 16) - kBiasX, static_cast<int>(gy >> 16) - kBiasY, x + 1, out);
  }
  for (; x < last - 1; ++x) {
    const int gx = (m[x + 2] - m[x - 2]) + 2 * (m[x + 1] - m[x - 1]);
    const int gy = s[x - 2] + s[x + 2] + 4 * (s[x - 1] + s[x + 1]) + 6 * s[x] - kBiasY;
    put(gx, gy, x, out);
  }
}

}  // namespace berth
