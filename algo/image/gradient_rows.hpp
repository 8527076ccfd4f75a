// Smoothed gradient of the search grid on line buffers.
//
// Each cell is the sum of its pixels scaled to 2 x DN (0..510). The gradient is that of the image
// smoothed by the binomial [1 4 6 4 1] across and [1 2 1] along the derivative, with the central
// difference: kernels [1 4 6 4 1] and [-1 -2 0 2 1]. Both are a Sobel operator on S, the cells
// smoothed by [1 2 1] x [1 2 1], and all is done by sums of two neighbours:
//   q = c + c', h = q + q' along the row; p = h + h', S = (p + p') / 2 down the column;
//   t = S + S', v = t + t', d = t - t' down the column; gx = v'' - v, gy = d + 2 d' + d'' along.
// Output unit: 128 = 1 DN per cell. Ranges: h 0..2040, S 0..4080, v 0..16320, d -3060..3060,
// gradients -12240..12240: everything fits 16 bits. Two pixels one above the other are averaged
// with the half cut off, as is S: less than 26 units in all, 5 rms on noise.
//
// Two columns are worked on at a time, as the lanes of a word (image/packed.hpp). They are not
// neighbours but `lane_offset` apart, left and right half of the row, so that neighbours are found
// in the word before and after and no word is ever taken apart. The halves overlap by what the
// kernels need. Every pixel is read once, in order. Cost: about 17 instructions per cell
// of 1 x 1 or 2 x 2 pixels, 23 of 4 x 4.
#pragma once

#include <cstdint>

#include "core/span.hpp"
#include "image/packed.hpp"
#include "image/search_grid.hpp"
#include "image/view.hpp"

namespace berth {

constexpr int kMaxGridSide = 1024;
constexpr int kMinGridWidth = 12;
constexpr int kGridBorder = 4;      // outermost cells of the grid that are no edge pixels
constexpr int kGradientUnit = 128;  // gradient of 1 DN per cell
constexpr int kMaxRowWords = kMaxGridSide / 2 + kGridBorder;

/// One cell's numbers, and by an index those of the cells before and after it in the row.
class GradientLane {
 public:
  explicit GradientLane(const void* first_number) : at_(static_cast<const char*>(first_number)) {}
  int gx(int words_on = 0) const { return number(16 * words_on); }
  int gy(int words_on = 0) const { return number(16 * words_on + 4); }
  int magnitude(int words_on = 0) const { return number(16 * words_on + 8); }

 private:
  int number(int offset) const {
    std::int16_t value;
    std::memcpy(&value, at_ + offset, sizeof value);
    return value;
  }
  const char* at_;
};

/// Gradients of two cells of a row, RowLayout::offset columns apart.
struct alignas(8) GradientWord {
  Pair gradient[2];  // gx and gy; before they are known v and d of the column two before
  Pair magnitude;    // |gx| + |gy|, 0..24480

  GradientLane lane(int index) const {
    return GradientLane(reinterpret_cast<const char*>(this) + 2 * index);
  }
};
static_assert(sizeof(GradientWord) == 16);

/// How the columns of a row are dealt to words and lanes: word k holds columns k and k + offset.
struct RowLayout {
  int words = 0;
  int offset = 0;

  /// kMinGridWidth <= width <= kMaxGridSide. The lanes share at least 7 columns; words come in
  /// fours.
  explicit RowLayout(int width) : words((width + 14) / 8 * 4), offset(width - words) {}
  /// The lane whose neighbours are at hand, for a column in 2..width - 3.
  int lane_of(int x) const { return x < offset + kGridBorder ? 0 : 1; }
  int word_of(int x) const { return x - lane_of(x) * offset; }
};

/// Line buffers.
struct GradientRows {
  struct alignas(8) Column {
    Pair h_and_p[2], s_and_t[2];  // of the row before
  };
  Column columns[kMaxRowWords];
  // Of the last three rows; before that their v and d. Two words are read beyond a row's end.
  GradientWord gradients[3][kMaxRowWords + 2];
  // Words of which a cell reaches the threshold, ascending: of the last row and of the one before.
  std::uint16_t strong_words[2][kMaxRowWords];
  int strong_count[2];

  const GradientWord* row(int y) const { return gradients[y % 3]; }
  Span<const std::uint16_t> strong(int y) const {
    return {strong_words[y % 2], static_cast<std::size_t>(strong_count[y % 2])};
  }
};

/// Read and smooth grid row `y`; rows must come in order. 0 <= y < grid.height.
void smooth_row(const ImageView& image, const SearchGrid& grid, int y, GradientRows& rows);

/// Gradient of grid row `y` of a grid `width` cells wide, after row y + 2 and all before have been
/// smoothed, and the list of the words of which a cell has a magnitude of at least `threshold`
/// (1..32767). Valid for columns 2..width - 3.
void differentiate_row(int width, int y, int threshold, GradientRows& rows);

}  // namespace berth
