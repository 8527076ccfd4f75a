#include "edge/detect.hpp"

#include <cstring>

#include "edge/ridges.hpp"

namespace berth {
namespace {

constexpr std::uint32_t kStepsPerCell = 18, kStepsPerCoarseCell = 28;
constexpr std::uint32_t kStepsPerStrongWord = 32, kStepsPerRidge = 35;
constexpr std::uint32_t kStepsPerPixel = 140, kStepsPerMovedPixel = 20;

inline int absolute(int v) { return v < 0 ? -v : v; }

// Vertex of the parabola through magnitudes at -1, 0, +1, in 1/64 cell, -32..31.
int vertex_offset(int before, int here, int after) {
  const int curvature = 2 * here - before - after;
  if (curvature <= 0) return 0;
  const int offset = 32 * (after - before) / curvature;
  return offset < -32 ? -32 : (offset > 31 ? 31 : offset);
}

struct ThreeRows {
  const GradientWord *up, *here, *down;
};

// The numbers of one cell and of its neighbours, which are a word or a row apart.
class Cell {
 public:
  Cell(const ThreeRows& rows, int word, int lane)
      : up_(rows.up[word].lane(lane)),
        here_(rows.here[word].lane(lane)),
        down_(rows.down[word].lane(lane)) {}

  int gx() const { return here_.gx(); }
  int gy() const { return here_.gy(); }
  int magnitude() const { return here_.magnitude(); }
  int left() const { return here_.magnitude(-1); }
  int right() const { return here_.magnitude(1); }
  int above() const { return up_.magnitude(); }
  int below() const { return down_.magnitude(); }
  // Twice Lxx and Lyy, four times Lxy: central differences of the gradient.
  int xx2() const { return here_.gx(1) - here_.gx(-1); }
  int yy2() const { return down_.gy() - up_.gy(); }
  int xy4() const { return down_.gx() - up_.gx() + here_.gy(1) - here_.gy(-1); }

 private:
  GradientLane up_, here_, down_;
};

// Lvv. The direction is cut to 7 bits (error below 0.5 deg), so the quadratic form stays below
// 127^2 (2 * 24480 + 48960) < 2^31; it is at most 2 * 24480 of the square of the direction's norm.
int isophote_second_derivative(const Cell& cell) {
  int a = cell.gx(), b = cell.gy();
  const unsigned largest = static_cast<unsigned>(absolute(a) | absolute(b) | 127);
  const int shift = 25 - __builtin_clz(largest);  // 0..8, what is left has 7 bits
  a >>= shift;
  b >>= shift;
  const int norm = a * a + b * b;
  BERTH_RANGE(norm > 0);  // the magnitude reaches the threshold
  return (b * b * cell.xx2() - a * b * cell.xy4() + a * a * cell.yy2()) / (2 * norm);
}

// Keeps the pool's invariants while rows are appended.
class Appender {
 public:
  Appender(EdgeMap& map, int threshold) : map_(map), threshold_(threshold) {
    map_.count = 0;
    map_.block_start[0] = 0;
  }

  const EdgeMap& map() const { return map_; }
  int threshold() const { return threshold_; }
  bool pool_full() const { return pool_full_; }
  std::uint32_t steps() const { return steps_; }  // of work, so far

  /// Block starts from `first` (exclusive of earlier ones) up to and including `last`.
  void start_blocks(int last) {
    while (next_block_ <= last) {
      map_.block_start[static_cast<std::size_t>(next_block_++)] =
          static_cast<std::uint16_t>(map_.count);
    }
  }

  /// Room for one pixel; may raise the threshold.
  void make_room() {
    if (map_.count == static_cast<int>(map_.pixels.size())) raise_threshold();
  }

  void append(const EdgePixel& pixel, int magnitude) {
    map_.pixels[static_cast<std::size_t>(map_.count++)] = pixel;
    ++counts_[magnitude / kStep];
    steps_ += kStepsPerPixel;
  }

 private:
  static constexpr int kStep = 64;
  static constexpr int kLevels = 24480 / kStep + 1;

  // The lowest multiple of kStep that frees a quarter of the pool. Forgets the counts below it.
  int threshold_that_frees_a_quarter() {
    int dropped = 0;
    int level = 0;
    while (level < kLevels - 1 && dropped * 4 < map_.count) {
      dropped += counts_[level];
      counts_[level++] = 0;
    }
    return level * kStep;
  }

  [[gnu::noinline]] void raise_threshold() {
    pool_full_ = true;
    steps_ += static_cast<std::uint32_t>(map_.count) * kStepsPerMovedPixel;
    threshold_ = threshold_that_frees_a_quarter();
    EdgePixel* const pixels = map_.pixels.data();
    int kept = 0;
    int read = 0;
    for (int block = 0; block < next_block_; ++block) {
      // Pixels of block b are those before the start of block b + 1 (or the end of what is stored).
      const int end = block + 1 < next_block_
                          ? map_.block_start[static_cast<std::size_t>(block + 1)]
                          : map_.count;
      map_.block_start[static_cast<std::size_t>(block)] = static_cast<std::uint16_t>(kept);
      for (; read < end; ++read) {
        if (pixels[read].magnitude() >= threshold_) pixels[kept++] = pixels[read];
      }
    }
    map_.count = kept;
  }

  EdgeMap& map_;
  int threshold_;
  int next_block_ = 0;
  bool pool_full_ = false;
  std::uint32_t steps_ = 0;
  std::uint16_t counts_[kLevels] = {};  // of the stored pixels' magnitudes
};

EdgePixel make_pixel(const Cell& c, int x) {
  EdgePixel p;
  p.gx = static_cast<std::int16_t>(c.gx());
  p.gy = static_cast<std::int16_t>(c.gy());
  const int offset = p.is_steep_in_x() ? vertex_offset(c.left(), c.magnitude(), c.right())
                                       : vertex_offset(c.above(), c.magnitude(), c.below());
  p.x_and_offset = static_cast<std::uint16_t>((x << 6) | (offset + 32));
  p.lvv = static_cast<std::int16_t>(isophote_second_derivative(c));
  return p;
}

// Ridges of row y among one lane's words before `last`. A function of its own: inlined into the
// loop over rows it would live on the stack.
[[gnu::noinline]] void append_lane(const ThreeRows& rows, const Ridges& ridges, int lane, int last,
                                   int row_block, Appender& out) {
  const int offset = lane * RowLayout(out.map().width).offset;
  for (int i = 0; i < ridges.count[lane] && ridges.words[lane][i] < last; ++i) {
    const int word = ridges.words[lane][i];
    const Cell cell(rows, word, lane);
    out.make_room();
    const int magnitude = cell.magnitude();
    if (magnitude < out.threshold()) continue;
    const int x = word + offset;
    out.start_blocks(row_block + (x >> out.map().block_shift));
    out.append(make_pixel(cell, x), magnitude);
  }
}

// Edge pixels of row y, of the left lane before those of the right one. Columns that both lanes
// hold are taken from the left one.
void append_row(const GradientRows& rows, const Ridges& ridges, int y, Appender& out) {
  const RowLayout layout(out.map().width);
  const ThreeRows three = {rows.row(y - 1), rows.row(y), rows.row(y + 1)};
  const int row_block = out.map().block_index(0, y);
  append_lane(three, ridges, 0, layout.offset + kGridBorder, row_block, out);
  append_lane(three, ridges, 1, layout.words - kGridBorder, row_block, out);
}

}  // namespace

int edge_threshold(std::uint16_t noise_q8, Q<16> sigmas, int bin) {
  // One component of the gradient of white noise of 1 DN: the kernels' norms are
  // sqrt(70) / 16 and sqrt(10) / 8 of a unit slope, so 0.2067 * 128 = 26.5 units; binning halves
  // it.
  const std::int64_t unit_q8 = 6774 / bin;
  const std::int64_t noise =
      shift_round(std::int64_t{noise_q8} * unit_q8 * sigmas.raw(), 8 + 8 + 16);
  // The weakest edge of the envelope: 30 DN, 2 px of defocus, 6 px of motion across it, on a ring
  // 5 px wide: 4.3 DN per 2 px cell. Half of that leaves room for noise and vignetting.
  const std::int64_t floor = bin * kGradientUnit;
  const std::int64_t threshold = noise > floor ? noise : floor;
  return static_cast<int>(threshold > 24000 ? 24000 : threshold);
}

DetectOutcome detect_edges(const ImageView& image, const SearchGrid& grid, int threshold,
                           GradientRows& rows, EdgeMap& map, Work& work) {
  map.width = grid.width;
  map.height = grid.height;
  map.block_shift = grid.width > 512 ? 7 : grid.width > 256 ? 6 : 5;
  // At a row's ends numbers of other rows are looked at, though never kept: their count is work.
  std::memset(static_cast<void*>(&rows), 0, sizeof rows);
  Appender out(map, threshold);
  const int words = RowLayout(grid.width).words;
  Ridges ridges;  // 2 KiB
  const bool has_inside = grid.width >= kMinGridWidth && grid.height > 2 * kGridBorder;
  for (int y = 0; has_inside && y < grid.height && !work.is_spent(); ++y) {
    const std::uint32_t before = out.steps();
    work.spend(static_cast<std::uint32_t>(grid.width) *
               (is_coarse(grid) ? kStepsPerCoarseCell : kStepsPerCell));
    smooth_row(image, grid, y, rows);
    if (y < kGridBorder) continue;
    differentiate_row(grid.width, y - 2, out.threshold(), rows);
    const int here = y - 3;  // the last row whose lower neighbours are known
    if (here >= kGridBorder && here < grid.height - kGridBorder) {
      find_ridges(rows, here, words, out.threshold(), ridges);
      append_row(rows, ridges, here, out);
      work.spend(static_cast<std::uint32_t>(rows.strong(here).size()) * kStepsPerStrongWord +
                 static_cast<std::uint32_t>(ridges.count[0] + ridges.count[1]) * kStepsPerRidge +
                 out.steps() - before);
    }
  }
  out.start_blocks(grid.height * kBlocksPerRow);
  return {out.threshold(), out.pool_full()};
}

}  // namespace berth
