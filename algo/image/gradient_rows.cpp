#include "image/gradient_rows.hpp"

namespace berth {
namespace {

// The cells of both lanes, each class at its own binning; next() is the sum of the cell before and
// the next one, so that every pixel is read once.

// Cells of 2 x 2 pixels, read two at a time.
template <std::uint32_t kFlip>
class BinnedCells {
 public:
  BinnedCells(const std::uint8_t* left, const std::uint8_t* right, int stride)
      : left_{left}, right_{right}, stride_(stride) {}
  Pair first() {
    const Pair right = read(right_);
    return read(left_) + (right << 16);
  }
  Pair second() const { return sum_bytes(left_.means) + (sum_bytes(right_.means) << 16); }

 private:
  struct Lane {
    const std::uint8_t* at;
    std::uint32_t means = 0;
  };
  std::uint32_t read(Lane& lane) const {
    const std::uint32_t last = lane.means;
    const std::uint32_t lower = load(lane.at + stride_) ^ kFlip;
    lane.means = halve_byte_sums(load_next(lane.at) ^ kFlip, lower);
    return sum_bytes(first_and_second(lane.means, last));
  }
  Lane left_, right_;
  const int stride_;
};

// Cells of 4 x 4 pixels.
template <std::uint32_t kFlip>
class CoarseCells {
 public:
  CoarseCells(const std::uint8_t* left, const std::uint8_t* right, int stride)
      : left_(left),
        right_(right),
        row_(stride),
        two_rows_(hidden(2 * stride)),
        three_rows_(hidden(3 * stride)) {}
  Pair first() { return next(); }
  Pair second() { return next(); }

 private:
  Pair next() {
    const Pair right = next_cell(right_);
    const Pair cells = next_cell(left_) + (right << 16);
    const Pair sum = halve_sums(before_, cells);
    before_ = cells;
    return sum;
  }
  // In 4 x DN.
  std::uint32_t next_cell(const std::uint8_t*& at) const {
    const std::uint32_t lower =
        halve_byte_sums(load(at + two_rows_) ^ kFlip, load(at + three_rows_) ^ kFlip);
    const std::uint32_t second = load(at + row_) ^ kFlip;
    return sum_bytes(halve_byte_sums(halve_byte_sums(load_next(at) ^ kFlip, second), lower));
  }
  const std::uint8_t *left_, *right_;
  const int row_, two_rows_, three_rows_;
  Pair before_ = 0;  // in 4 x DN
};

// Cells of one pixel.
class SingleCells {
 public:
  SingleCells(const std::uint8_t* left, const std::uint8_t* right, std::uint32_t flip)
      : left_(left), right_(right), flip_(both(flip)) {}
  Pair first() { return next(); }
  Pair second() { return next(); }

 private:
  Pair next() {
    const Pair cells = 2 * ((*left_++ | static_cast<std::uint32_t>(*right_++) << 16) ^ flip_);
    const Pair sum = before_ + cells;
    before_ = cells;
    return sum;
  }
  const std::uint8_t *left_, *right_;
  const Pair flip_;
  Pair before_ = 0;
};

// The sums along the row, then down the column; word k + 1 of `out` receives v and d of word k.
template <typename Cells>
void sum_rows(Cells cells, int words, GradientRows::Column* column, GradientWord* out) {
  Pair q = 0;
  const auto step = [&](Pair sum, GradientRows::Column& above, GradientWord& to) {
    const TwoPairs rough = load_two(above.h_and_p);
    const Pair h = sum + q;
    q = sum;
    const Pair p = h + rough.first;
    store_two(above.h_and_p, h, p);
    const Pair s = halve_sums(p, rough.second);
    const TwoPairs smooth = load_two(above.s_and_t);
    const Pair t = s + smooth.first;
    store_two(above.s_and_t, s, t);
    store_two(to.gradient, t + smooth.second, subtract_pairs(t, smooth.second));
  };
  for (const GradientWord* const end = out + words; out != end; out += 4, column += 4) {
    step(cells.first(), column[0], out[0]);
    step(cells.second(), column[1], out[1]);
    step(cells.first(), column[2], out[2]);
    step(cells.second(), column[3], out[3]);
  }
}

template <std::uint32_t kFlip>
void sum_binned_rows(int bin, int stride, const std::uint8_t* left, const std::uint8_t* right,
                     int words, GradientRows::Column* column, GradientWord* out) {
  if (bin == 2) {
    sum_rows(BinnedCells<kFlip>(left, right, stride), words, column, out);
  } else {
    sum_rows(CoarseCells<kFlip>(left, right, stride), words, column, out);
  }
}

}  // namespace

void smooth_row(const ImageView& image, const SearchGrid& grid, int y, GradientRows& rows) {
  BERTH_RANGE(grid.width >= kMinGridWidth && grid.width <= kMaxGridSide);
  const RowLayout layout(grid.width);
  GradientWord* const out = rows.gradients[(y + 1) % 3];
  const std::uint8_t* left = image.row(grid.y0 + grid.bin * y) + grid.x0;
  const std::uint8_t* right = left + grid.bin * layout.offset;
  if (grid.bin == 1) {
    sum_rows(SingleCells(left, right, image.polarity_mask), layout.words, rows.columns, out);
  } else if (image.polarity_mask == 0) {
    sum_binned_rows<0>(grid.bin, image.stride, left, right, layout.words, rows.columns, out);
  } else {
    sum_binned_rows<0xffffffffu>(grid.bin, image.stride, left, right, layout.words, rows.columns,
                                 out);
  }
}

void differentiate_row(int width, int y, int threshold, GradientRows& rows) {
  BERTH_RANGE(y >= 2 && threshold > 0 && threshold < 32768);
  const int words = RowLayout(width).words;
  GradientWord* const row = rows.gradients[y % 3];
  const Pair below = both(static_cast<std::uint32_t>(threshold - 1));
  std::uint16_t* const list = rows.strong_words[y % 2];
  std::uint16_t* strong = list;
  Pair d_last = 0, e_last = 0;
  // Reads v and d of word k + 1, which lie in word k + 2, and writes the gradients of word k.
  const auto step = [&](GradientWord* at, int k, Pair& v_before) {
    const TwoPairs ahead = load_two(at[2].gradient);
    const Pair v = ahead.first, d = ahead.second;
    const Pair e = add_pairs(d, d_last);
    const Pair gx = subtract_pairs(v, v_before);
    const Pair gy = add_pairs(e, e_last);
    v_before = v;
    d_last = d;
    e_last = e;
    store_two(at->gradient, gx, gy);
    const Pair magnitude = absolute_pair(gx) + absolute_pair(gy);
    at->magnitude = magnitude;
    if (excess(magnitude, below) != 0) *strong++ = static_cast<std::uint16_t>(k);
  };
  Pair v_even = 0, v_odd = 0;
  GradientWord* at = row;
  for (int k = 0; k < words; k += 4) {
    step(at, k, v_even);
    step(at + 1, k + 1, v_odd);
    at = hidden(at + 2);
    step(at, k + 2, v_even);
    step(at + 1, k + 3, v_odd);
    at = hidden(at + 2);
  }
  rows.strong_count[y % 2] = static_cast<int>(strong - list);
}

}  // namespace berth
