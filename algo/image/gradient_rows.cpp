#include "image/gradient_rows.hpp"

namespace berth {
namespace {

// Sums of two neighbouring cells each, of left and right lane.
struct TwoSums {
  Pair first, second;
};

// Cells of 2 x 2 pixels: one lane's pixels, four columns at a time.
template <std::uint32_t kFlip>
class BinnedLane {
 public:
  BinnedLane(const std::uint8_t* upper, int stride) : upper_(upper), stride_(stride) {}
  // Bytes of the cell before and of the next two.
  void advance() {
    last_ = means_;
    means_ = halve_byte_sums(load(upper_) ^ kFlip, load(upper_ + stride_) ^ kFlip);
    upper_ += 4;
  }
  std::uint32_t first() const { return sum_bytes(last_ >> 16 | means_ << 16); }
  std::uint32_t second() const { return sum_bytes(means_); }

 private:
  const std::uint8_t* upper_;
  int stride_;
  std::uint32_t means_ = 0, last_ = 0;
};

// Cells of 4 x 4 pixels: one lane's pixels.
template <std::uint32_t kFlip>
class CoarseLane {
 public:
  CoarseLane(const std::uint8_t* upper, int stride) : upper_(upper), stride_(stride) {}
  void advance() {
    before_ = second_;
    first_ = next_cell();
    second_ = next_cell();
  }
  std::uint32_t first() const { return (before_ + first_) >> 1; }
  std::uint32_t second() const { return (first_ + second_) >> 1; }

 private:
  // The next cell in 4 x DN.
  std::uint32_t next_cell() {
    const auto pixels = [this](int row) { return load(upper_ + row * stride_) ^ kFlip; };
    const std::uint32_t means = halve_byte_sums(halve_byte_sums(pixels(0), pixels(1)),
                                                halve_byte_sums(pixels(2), pixels(3)));
    upper_ += 4;
    return sum_bytes(means);
  }
  const std::uint8_t* upper_;
  int stride_;
  std::uint32_t before_ = 0, first_ = 0, second_ = 0;
};

// Cells of one pixel.
class SingleLane {
 public:
  SingleLane(const std::uint8_t* pixels, std::uint8_t flip) : pixels_(pixels), flip_(flip) {}
  void advance() {
    before_ = second_;
    first_ = static_cast<std::uint32_t>(*pixels_++ ^ flip_);
    second_ = static_cast<std::uint32_t>(*pixels_++ ^ flip_);
  }
  std::uint32_t first() const { return 2 * (before_ + first_); }
  std::uint32_t second() const { return 2 * (first_ + second_); }

 private:
  const std::uint8_t* pixels_;
  std::uint8_t flip_;
  std::uint32_t before_ = 0, first_ = 0, second_ = 0;
};

// The sums along the row, then down the column; word k + 1 of `out` receives v and d of word k.
template <typename Lane>
void sum_rows(Lane left, Lane right, int words, GradientRows::Column* column, GradientWord* out) {
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
    left.advance();
    right.advance();
    step(left.first() + (right.first() << 16), column[0], out[0]);
    step(left.second() + (right.second() << 16), column[1], out[1]);
    left.advance();
    right.advance();
    step(left.first() + (right.first() << 16), column[2], out[2]);
    step(left.second() + (right.second() << 16), column[3], out[3]);
  }
}

template <std::uint32_t kFlip>
void sum_binned_rows(int bin, int stride, const std::uint8_t* left, const std::uint8_t* right,
                     int words, GradientRows::Column* column, GradientWord* out) {
  if (bin == 2) {
    using Lane = BinnedLane<kFlip>;
    sum_rows(Lane(left, stride), Lane(right, stride), words, column, out);
  } else {
    using Lane = CoarseLane<kFlip>;
    sum_rows(Lane(left, stride), Lane(right, stride), words, column, out);
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
    using Lane = SingleLane;
    const std::uint8_t flip = image.polarity_mask;
    sum_rows(Lane(left, flip), Lane(right, flip), layout.words, rows.columns, out);
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
    const TwoPairs ahead = load_two(at[k + 2].gradient);
    const Pair v = ahead.first, d = ahead.second;
    const Pair e = add_pairs(d, d_last);
    const Pair gx = subtract_pairs(v, v_before);
    const Pair gy = add_pairs(e, e_last);
    v_before = v;
    d_last = d;
    e_last = e;
    store_two(at[k].gradient, gx, gy);
    const Pair magnitude = absolute_pair(gx) + absolute_pair(gy);
    at[k].magnitude = magnitude;
    if (excess(magnitude, below) != 0) *strong++ = static_cast<std::uint16_t>(at - row + k);
  };
  Pair v_even = 0, v_odd = 0;
  for (GradientWord *at = row, *const end = row + words; at != end; at += 4) {
    step(at, 0, v_even);
    step(at, 1, v_odd);
    step(at, 2, v_even);
    step(at, 3, v_odd);
  }
  rows.strong_count[y % 2] = static_cast<int>(strong - list);
}

}  // namespace berth
