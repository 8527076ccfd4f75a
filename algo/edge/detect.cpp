#include "edge/detect.hpp"

#include <cstring>

#include "edge/ridges.hpp"

namespace berth {
namespace {

constexpr std::uint32_t kStepsPerCell = 18, kStepsPerCoarseCell = 24;
constexpr std::uint32_t kStepsPerStrongWord = 27, kStepsPerRidge = 33;
constexpr std::uint32_t kStepsPerPixel = 95, kStepsPerMovedPixel = 20;

inline int absolute(int v) { return v < 0 ? -v : v; }

// Three rows' numbers of one lane.
struct LaneRows {
  const char *up, *here, *down;

  LaneRows(const GradientRows& rows, int y, int lane)
      : up(hidden(first_of(rows.row(y - 1), lane))),
        here(hidden(first_of(rows.row(y), lane))),
        down(hidden(first_of(rows.row(y + 1), lane))) {}

 private:
  static const char* first_of(const GradientWord* row, int lane) {
    return reinterpret_cast<const char*>(row) + 2 * lane;
  }
};

// The numbers of one cell and of its neighbours, which are a word or a row apart.
struct Cell {
  GradientLane up, here, down;

  Cell(const LaneRows& rows, int word)
      : up(hidden(rows.up + word * static_cast<int>(sizeof(GradientWord)))),
        here(hidden(rows.here + word * static_cast<int>(sizeof(GradientWord)))),
        down(hidden(rows.down + word * static_cast<int>(sizeof(GradientWord)))) {}

  // Twice Lxx and Lyy, four times Lxy: central differences of the gradient.
  int xx2() const { return here.gx(1) - here.gx(-1); }
  int yy2() const { return down.gy() - up.gy(); }
  int xy4() const { return down.gx() - up.gx() + here.gy(1) - here.gy(-1); }
};

// Vertex of the parabola through magnitudes at -1, 0, +1, in 1/64 cell, -32..31.
int vertex_offset(int before, int here, int after) {
  const int curvature = 2 * here - before - after;
  if (curvature <= 0) return 0;
  return saturate_six_bits(32 * (after - before) / curvature);
}

// Lvv. The direction is cut to 7 bits (error below 0.5 deg), so the quadratic form stays below
// 127^2 (2 * 24480 + 48960) < 2^31; it is at most 2 * 24480 of the square of the direction's norm.
// `bits` has the highest one of the gradient's components.
int isophote_second_derivative(const Cell& cell, int gx, int gy, int bits) {
  const int shift = 25 - __builtin_clz(static_cast<unsigned>(bits | 127));  // 0..8, 7 bits are left
  const int a = gx >> shift, b = gy >> shift;
  const int aa = a * a, bb = b * b;
  BERTH_RANGE(aa + bb > 0);  // the magnitude reaches the threshold
  return (bb * cell.xx2() - a * b * cell.xy4() + aa * cell.yy2()) / (2 * (aa + bb));
}

void make_pixel(const Cell& cell, int x, EdgePixel& pixel) {
  const int gx = hidden(cell.here.gx()), gy = hidden(cell.here.gy());
  const int ax = absolute(gx), ay = absolute(gy);
  // Along the dominant axis.
  const int offset = ax >= ay
                         ? vertex_offset(cell.here.magnitude(-1), ax + ay, cell.here.magnitude(1))
                         : vertex_offset(cell.up.magnitude(), ax + ay, cell.down.magnitude());
  pixel.x_and_offset = static_cast<std::uint16_t>((x << 6) + offset + 32);
  pixel.gx = static_cast<std::int16_t>(gx);
  pixel.gy = static_cast<std::int16_t>(gy);
  pixel.lvv = static_cast<std::int16_t>(isophote_second_derivative(cell, gx, gy, ax | ay));
}

// Keeps the pool's invariants while rows are appended.
class Appender {
 public:
  Appender(EdgeMap& map, int threshold)
      : map_(map),
        pixels_(map.pixels.data()),
        starts_(map.block_start.data()),
        end_(pixels_ + map.pixels.size()),
        next_(pixels_),
        threshold_(threshold) {
    starts_[0] = 0;
  }

  const EdgeMap& map() const { return map_; }
  int threshold() const { return threshold_; }
  bool pool_full() const { return pool_full_; }
  // Of work, so far.
  std::uint32_t steps() const {
    return moved_ * kStepsPerMovedPixel +
           static_cast<std::uint32_t>(dropped_ + count()) * kStepsPerPixel;
  }

  /// Block starts from `first` (exclusive of earlier ones) up to and including `last`.
  void start_blocks(int last) {
    while (next_block_ <= last) starts_[next_block_++] = static_cast<std::uint16_t>(count());
  }

  /// Room for one pixel; may raise the threshold.
  void make_room() {
    if (next_ == end_) raise_threshold();
  }

  /// The place of one more pixel.
  EdgePixel& append(int magnitude) {
    ++counts_[static_cast<unsigned>(magnitude) / kStep];
    return *next_++;
  }

  void end() {
    start_blocks(map_.height * kBlocksPerRow);
    map_.count = count();
  }

 private:
  int count() const { return static_cast<int>(next_ - pixels_); }

  static constexpr int kStep = 64;
  static constexpr int kLevels = 24480 / kStep + 1;

  // The lowest multiple of kStep that frees a quarter of the pool. Forgets the counts below it.
  int threshold_that_frees_a_quarter() {
    const int stored = count();
    int dropped = 0;
    int level = 0;
    while (level < kLevels - 1 && dropped * 4 < stored) {
      dropped += counts_[level];
      counts_[level++] = 0;
    }
    return level * kStep;
  }

  [[gnu::noinline]] void raise_threshold() {
    pool_full_ = true;
    moved_ += static_cast<std::uint32_t>(count());
    threshold_ = threshold_that_frees_a_quarter();
    const int threshold = threshold_;
    EdgePixel* kept = pixels_;
    const EdgePixel* read = pixels_;
    for (int block = 0; block < next_block_; ++block) {
      // Pixels of block b are those before the start of block b + 1 (or the end of what is stored).
      const EdgePixel* const end = block + 1 < next_block_ ? pixels_ + starts_[block + 1] : next_;
      starts_[block] = static_cast<std::uint16_t>(kept - pixels_);
      for (; read != end; ++read) {
        if (read->magnitude() >= threshold) *kept++ = *read;
      }
    }
    dropped_ += static_cast<int>(next_ - kept);
    next_ = kept;
  }

  EdgeMap& map_;
  EdgePixel* const pixels_;
  std::uint16_t* const starts_;
  EdgePixel* const end_;
  EdgePixel* next_;
  int threshold_;
  int next_block_ = 0;
  bool pool_full_ = false;
  int dropped_ = 0;
  std::uint32_t moved_ = 0;
  std::uint16_t counts_[kLevels] = {};  // of the stored pixels' magnitudes
};

// Ridges of row y among one lane's words before `last`. A function of its own: inlined into the
// loop over rows it would live on the stack.
[[gnu::noinline]] void append_lane(const LaneRows& rows, const Ridges& ridges, int lane, int last,
                                   int row_block, Appender& out) {
  const int offset = lane * RowLayout(out.map().width).offset;
  const int shift = out.map().block_shift;
  const std::uint16_t *at = ridges.words[lane], *end = at + ridges.count[lane];
  while (at != end && end[-1] >= last) --end;
  for (; at != end; ++at) {
    const Cell cell(rows, *at);
    const int x = *at + offset;
    out.make_room();
    const int magnitude = cell.here.magnitude();
    if (magnitude < out.threshold()) continue;
    out.start_blocks(row_block + (x >> shift));
    make_pixel(cell, x, out.append(magnitude));
  }
}

// Edge pixels of row y, of the left lane before those of the right one. Columns that both lanes
// hold are taken from the left one.
void append_row(const GradientRows& rows, const Ridges& ridges, int y, Appender& out) {
  const RowLayout layout(out.map().width);
  const int row_block = out.map().block_index(0, y);
  append_lane(LaneRows(rows, y, 0), ridges, 0, layout.offset + kGridBorder, row_block, out);
  append_lane(LaneRows(rows, y, 1), ridges, 1, layout.words - kGridBorder, row_block, out);
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
  out.end();
  return {out.threshold(), out.pool_full()};
}

}  // namespace berth
