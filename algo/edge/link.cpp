#include "edge/link.hpp"

namespace berth {
namespace {

constexpr std::uint32_t kStepsPerPixel = 70, kStepsPerLook = 255;

struct Step {
  int dx, dy;
};

// The eight neighbours, clockwise in image axes (y down) from east.
constexpr Step kNeighbours[8] = {{1, 0},  {1, 1},   {0, 1},  {-1, 1},
                                 {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};

// Octant of a direction: 0 east, 2 south, 4 west, 6 north. Borders at 22.5 degrees (tan = 106/256).
int octant(int dx, int dy) {
  const int ax = dx < 0 ? -dx : dx, ay = dy < 0 ? -dy : dy;
  if (256 * ay < 106 * ax) return dx > 0 ? 0 : 4;
  if (256 * ax < 106 * ay) return dy > 0 ? 2 : 6;
  return dx > 0 ? (dy > 0 ? 1 : 7) : (dy > 0 ? 3 : 5);
}

std::int32_t dot(const EdgePixel& p, const EdgePixel& q) { return p.gx * q.gx + p.gy * q.gy; }

// Gradients of one edge agree within 60 degrees: 4 dot^2 > |p|^2 |q|^2, each below 2^29.
bool agrees(const EdgePixel& p, std::int32_t square_of_p, const EdgePixel& q) {
  const std::int32_t product = dot(p, q);
  return product > 0 && 4 * std::int64_t{product} * product > std::int64_t{square_of_p} * dot(q, q);
}

// How far beyond a turnoff a walk may have gone when it comes to nothing and goes back to it: the
// ridge of a corner, or of two maxima side by side, juts out by a pixel or two.
constexpr int kSpurPixels = 2;

// Edge pixels keep clear of the grid's border, so that cells two away are always inside it.
class Linker {
 public:
  Linker(const EdgeMap& map, ChainSet& set, const Work& work)
      : pixels_(map.pixels.data()),
        starts_(map.block_start.data()),
        shift_(map.block_shift),
        count_(map.count),
        row_of_(set.row_of.data()),
        visited_(set.visited.data()),
        set_(set),
        most_looks_(work.left() / kStepsPerLook) {}

  bool is_spent() const { return looks_ >= most_looks_; }
  std::uint32_t steps() const { return looks_ * kStepsPerLook; }  // of work

  bool is_visited(int i) const { return (visited_[i >> 5] >> (i & 31) & 1u) != 0; }

  void visit(int i) { visited_[i >> 5] |= 1u << (i & 31); }

  // Walk from pixel `i` along the isophote (sign +1) or against it (-1), appending to `order`.
  // Bounded: every step visits a pixel.
  int walk(int i, int sign, int length) {
    Turnoff turnoff;
    for (int steps = 0; steps < count_ && looks_ < most_looks_; ++steps) {
      Choice next = take_best_ahead(i, sign);
      if (next.best == kNoEdge && length - turnoff.length <= kSpurPixels) {
        next = go_back(turnoff, sign, length);
      }
      if (next.best == kNoEdge) next.best = step_over_gap(i, sign);
      if (next.best == kNoEdge) return length;
      set_.order[static_cast<std::size_t>(length++)] = static_cast<std::uint16_t>(next.best);
      i = next.best;
      if (next.second != kNoEdge) turnoff = {next.second, length};
    }
    return length;
  }

 private:
  // Two neighbours ahead, the stronger first.
  struct Choice {
    int best = kNoEdge, second = kNoEdge;
  };

  // A neighbour that was not taken, and the chain's length with the one that was.
  struct Turnoff {
    int pixel = kNoEdge, length = 0;
  };

  // The strongest unvisited neighbours ahead; all candidates ahead become visited.
  Choice take_best_ahead(int i, int sign) {
    ++set_.steps;
    ++looks_;
    Choice choice;
    int largest = 0, next = 0;  // magnitudes
    for_each_ahead(i, sign, 0, [&](int candidate, int magnitude) {
      visit(candidate);
      if (magnitude > largest) {
        choice = {candidate, choice.best};
        next = largest;
        largest = magnitude;
      } else if (magnitude > next) {
        choice.second = candidate;
        next = magnitude;
      }
    });
    return choice;
  }

  // Give the weaker neighbour its chance. If it leads on, it takes the place of the stronger one
  // and of what followed it.
  Choice go_back(Turnoff& turnoff, int sign, int& length) {
    if (turnoff.pixel == kNoEdge) return {};
    const Choice next = take_best_ahead(turnoff.pixel, sign);
    if (next.best != kNoEdge) {
      length = turnoff.length;
      set_.order[static_cast<std::size_t>(length - 1)] = static_cast<std::uint16_t>(turnoff.pixel);
    }
    turnoff = {};
    return next;
  }

  int step_over_gap(int i, int sign) {
    int best = kNoEdge, largest = 0;
    ++looks_;
    for_each_ahead(i, sign, 1, [&](int candidate, int magnitude) {
      if (magnitude <= largest) return;
      best = candidate;
      largest = magnitude;
    });
    if (best != kNoEdge) visit(best);
    return best;
  }

  // Calls f(pixel, its magnitude) for those of the three neighbours ahead that are unvisited and
  // whose gradient agrees, or for the three that lie `on` a cell further.
  template <typename F>
  void for_each_ahead(int i, int sign, int on, F f) const {
    const EdgePixel& p = pixels_[i];
    const std::int32_t square = dot(p, p);
    const int ahead = octant(-sign * p.gy, sign * p.gx);
    const int x = p.x() + on * kNeighbours[ahead].dx, y = row_of_[i] + on * kNeighbours[ahead].dy;
    for (int k = ahead + 7; k < ahead + 10; ++k) {
      const Step s = kNeighbours[k & 7];
      const int candidate = s.dy == 0 && on == 0 ? beside(i, s.dx) : find(x + s.dx, y + s.dy);
      if (candidate == kNoEdge || is_visited(candidate)) continue;
      if (agrees(p, square, pixels_[candidate])) f(candidate, pixels_[candidate].magnitude());
    }
  }

  // The pixel to the right (dx 1) or to the left (-1), whose place in the map is the next one. At
  // the map's ends the pixel itself is looked at.
  int beside(int i, int dx) const {
    const int other = i + dx >= 0 && i + dx < count_ ? i + dx : i;
    const bool is_beside =
        pixels_[other].x() == pixels_[i].x() + dx && row_of_[other] == row_of_[i];
    return is_beside ? other : kNoEdge;
  }

  int find(int x, int y) const {
    const std::uint16_t* const start = starts_ + y * kBlocksPerRow + (x >> shift_);
    for (int i = start[0], end = start[1]; i < end; ++i) {
      const int column = pixels_[i].x();
      if (column >= x) return column == x ? i : kNoEdge;
    }
    return kNoEdge;
  }

  const EdgePixel* const pixels_;
  const std::uint16_t* const starts_;
  const int shift_, count_;
  const std::uint16_t* const row_of_;
  std::uint32_t* const visited_;
  ChainSet& set_;
  const std::uint32_t most_looks_;
  std::uint32_t looks_ = 0;
};

void reverse(Span<std::uint16_t> order, int begin, int end) {
  for (--end; begin < end; ++begin, --end) {
    const std::uint16_t swap = order[static_cast<std::size_t>(begin)];
    order[static_cast<std::size_t>(begin)] = order[static_cast<std::size_t>(end)];
    order[static_cast<std::size_t>(end)] = swap;
  }
}

void fill_rows(const EdgeMap& map, Span<std::uint16_t> row_of) {
  for (int y = 0; y < map.height; ++y) {
    for (int i = map.row_begin(y); i < map.row_end(y); ++i) {
      row_of[static_cast<std::size_t>(i)] = static_cast<std::uint16_t>(y);
    }
  }
}

void clear_marks(int pixels, ChainSet& set) {
  for (int w = 0; w < (pixels + 31) / 32; ++w) set.visited[static_cast<std::size_t>(w)] = 0;
}

}  // namespace

void link_edges(const EdgeMap& map, int anchor_threshold, ChainSet& set, Work& work) {
  set.count = 0;
  set.steps = 0;
  set.pool_full = false;
  clear_marks(map.count, set);
  if (!work.take(static_cast<std::uint32_t>(map.count) * kStepsPerPixel)) return;
  fill_rows(map, set.row_of);
  Linker linker(map, set, work);
  int used = 0;
  for (int anchor = 0; anchor < map.count && !linker.is_spent(); ++anchor) {
    if (linker.is_visited(anchor) || map[anchor].magnitude() < anchor_threshold) continue;
    linker.visit(anchor);
    int end = linker.walk(anchor, -1, used);
    reverse(set.order, used, end);
    set.order[static_cast<std::size_t>(end++)] = static_cast<std::uint16_t>(anchor);
    end = linker.walk(anchor, +1, end);
    if (end - used < kMinChainPixels) continue;
    if (set.count == static_cast<int>(set.chains.size())) {
      set.pool_full = true;
      break;
    }
    set.chains[static_cast<std::size_t>(set.count++)] = {static_cast<std::uint16_t>(used),
                                                         static_cast<std::uint16_t>(end - used)};
    used = end;
  }
  work.spend(linker.steps());
  // From here on the bits say which pixels are part of a chain: neither side pixels nor fragments.
  clear_marks(map.count, set);
  for (int k = 0; k < used; ++k) linker.visit(set.order[static_cast<std::size_t>(k)]);
}

}  // namespace berth
