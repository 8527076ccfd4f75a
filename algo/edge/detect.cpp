#include "edge/detect.hpp"

namespace berth {
namespace {

constexpr int kBorder = 4;  // 2 cells of kernel, 1 of the maximum test, 1 of the second derivative

inline int absolute(int v) { return v < 0 ? -v : v; }

// Vertex of the parabola through magnitudes at -1, 0, +1, in 1/64 cell, -32..31.
int vertex_offset(int before, int here, int after) {
  const int curvature = 2 * here - before - after;
  if (curvature <= 0) return 0;
  const int offset = 32 * (after - before) / curvature;
  return offset < -32 ? -32 : (offset > 31 ? 31 : offset);
}

// Lvv by Lxx, Lxy, Lyy as central differences of the gradient rows. The direction is cut to 7 bits
// (error below 0.5 deg), so the quadratic form stays below 2 * 2 * 127^2 * 12240 < 2^30.
int isophote_second_derivative(const GradientRow& up, const GradientRow& here,
                               const GradientRow& down, int x) {
  int a = here.gx[x], b = here.gy[x];
  const int largest = absolute(a) | absolute(b);
  int shift = 0;
  while ((largest >> shift) > 127) ++shift;  // at most 8 rounds: |g| < 2^15
  a >>= shift;
  b >>= shift;
  const int xx = (here.gx[x + 1] - here.gx[x - 1]) / 2;
  const int yy = (down.gy[x] - up.gy[x]) / 2;
  const int xy = (down.gx[x] - up.gx[x] + here.gy[x + 1] - here.gy[x - 1]) / 4;
  const int norm = a * a + b * b;
  if (norm == 0) return 0;
  const int form = b * b * xx - 2 * a * b * xy + a * a * yy;
  const int lvv = form / norm;
  return lvv > 32767 ? 32767 : (lvv < -32767 ? -32767 : lvv);
}

// Keeps the pool's invariants while rows are appended.
class Appender {
 public:
  Appender(EdgeMap& map, int threshold) : map_(map), threshold_(threshold) {
    map_.count = 0;
    map_.block_start[0] = 0;
  }

  int threshold() const { return threshold_; }
  bool pool_full() const { return pool_full_; }

  /// Block starts from `first` (exclusive of earlier ones) up to and including `last`.
  void start_blocks(int last) {
    while (next_block_ <= last) {
      map_.block_start[static_cast<std::size_t>(next_block_++)] =
          static_cast<std::uint16_t>(map_.count);
    }
  }

  void append(const EdgePixel& pixel) {
    if (map_.count == static_cast<int>(map_.pixels.size())) raise_threshold();
    if (pixel.magnitude() < threshold_) return;
    map_.pixels[static_cast<std::size_t>(map_.count++)] = pixel;
  }

 private:
  // The lowest multiple of 1/8 octave that frees a quarter of the pool, by a histogram.
  int threshold_that_frees_a_quarter() const {
    constexpr int kLevels = 128;
    constexpr int kStep = 192;  // 128 levels of 192 cover 0..24575, the magnitude's whole range
    std::uint16_t histogram[kLevels] = {};
    for (int i = 0; i < map_.count; ++i) ++histogram[map_[i].magnitude() / kStep];
    int dropped = 0;
    int level = 0;
    while (level < kLevels - 1 && dropped * 4 < map_.count) dropped += histogram[level++];
    return level * kStep;
  }

  void raise_threshold() {
    pool_full_ = true;
    threshold_ = threshold_that_frees_a_quarter();
    int kept = 0;
    int read = 0;
    for (int block = 0; block < next_block_; ++block) {
      // Pixels of block b are those before the start of block b + 1 (or the end of what is stored).
      const int end = block + 1 < next_block_
                          ? map_.block_start[static_cast<std::size_t>(block + 1)]
                          : map_.count;
      map_.block_start[static_cast<std::size_t>(block)] = static_cast<std::uint16_t>(kept);
      for (; read < end; ++read) {
        if (map_[read].magnitude() < threshold_) continue;
        map_.pixels[static_cast<std::size_t>(kept++)] = map_[read];
      }
    }
    map_.count = kept;
  }

  EdgeMap& map_;
  int threshold_;
  int next_block_ = 0;
  bool pool_full_ = false;
};

struct Neighbourhood {
  const GradientRow& up;
  const GradientRow& here;
  const GradientRow& down;
};

// Is the pixel a maximum along x (or y)? Ties go to the first of two equal neighbours.
bool is_maximum_in_x(const Neighbourhood& n, int x) {
  const int m = n.here.magnitude[x];
  return m > n.here.magnitude[x - 1] && m >= n.here.magnitude[x + 1];
}

bool is_maximum_in_y(const Neighbourhood& n, int x) {
  const int m = n.here.magnitude[x];
  return m > n.up.magnitude[x] && m >= n.down.magnitude[x];
}

bool is_ridge(const Neighbourhood& n, int x) {
  const int ax = absolute(n.here.gx[x]), ay = absolute(n.here.gy[x]);
  if (ax >= ay ? is_maximum_in_x(n, x) : is_maximum_in_y(n, x)) return true;
  // Nearly diagonal (within 1 : 1.5): the ridge may only show along the other axis.
  const bool diagonal = 2 * ax < 3 * ay && 2 * ay < 3 * ax;
  return diagonal && (ax >= ay ? is_maximum_in_y(n, x) : is_maximum_in_x(n, x));
}

EdgePixel make_pixel(const Neighbourhood& n, int x) {
  EdgePixel p;
  p.gx = n.here.gx[x];
  p.gy = n.here.gy[x];
  const int m = n.here.magnitude[x];
  const int offset = p.is_steep_in_x()
                         ? vertex_offset(n.here.magnitude[x - 1], m, n.here.magnitude[x + 1])
                         : vertex_offset(n.up.magnitude[x], m, n.down.magnitude[x]);
  p.x_and_offset = static_cast<std::uint16_t>((x << 6) | (offset + 32));
  p.lvv = static_cast<std::int16_t>(isophote_second_derivative(n.up, n.here, n.down, x));
  return p;
}

void append_row(const Neighbourhood& n, int y, Appender& out, const EdgeMap& map) {
  for (int x = kBorder; x < map.width - kBorder; ++x) {
    if (n.here.magnitude[x] < out.threshold() || !is_ridge(n, x)) continue;
    out.start_blocks(map.block_index(x, y));
    out.append(make_pixel(n, x));
  }
}

}  // namespace

int edge_threshold(std::uint16_t noise_q8, Q<16> sigmas, int bin) {
  // One component of the gradient of white noise of 1 DN: the kernels' norms are
  // sqrt(70) / 16 and sqrt(10) / 8 of a unit slope, so 0.2067 * 128 = 26.5 units; binning halves
  // it.
  const std::int64_t unit_q8 = bin == 2 ? 3387 : 6774;
  const std::int64_t noise =
      shift_round(std::int64_t{noise_q8} * unit_q8 * sigmas.raw(), 8 + 8 + 16);
  // The weakest edge of the envelope: 30 DN, 2 px of defocus, 6 px of motion across it, on a ring
  // 5 px wide: 4.3 DN per 2 px cell. Half of that leaves room for noise and vignetting.
  const std::int64_t floor = (bin == 2 ? 2 : 1) * kGradientUnit;
  const std::int64_t threshold = noise > floor ? noise : floor;
  return static_cast<int>(threshold > 24000 ? 24000 : threshold);
}

DetectOutcome detect_edges(const ImageView& image, const SearchGrid& grid, int threshold,
                           GradientRows& rows, EdgeMap& map) {
  map.width = grid.width;
  map.height = grid.height;
  map.block_shift = grid.width > 512 ? 7 : 6;
  Appender out(map, threshold);
  const int last_row = grid.height - kBorder;
  for (int y = 0; y < grid.height; ++y) {
    bin_row(image, grid, y, rows);
    if (y >= 4) differentiate_row(grid, y - 2, rows);
    const int here = y - 3;
    if (here < kBorder || here >= last_row) continue;
    append_row({rows.row(here - 1), rows.row(here), rows.row(here + 1)}, here, out, map);
  }
  out.start_blocks(grid.height * kBlocksPerRow);
  return {out.threshold(), out.pool_full()};
}

}  // namespace berth
