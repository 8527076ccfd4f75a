#include "edge/link.hpp"

#include <cstddef>

#include "image/packed.hpp"

namespace berth {
namespace {

constexpr std::uint32_t kStepsPerPixel = 36, kStepsPerLook = 215;

struct Step {
  std::int8_t dx, dy;
};

// The eight neighbours, clockwise in image axes (y down) from east.
constexpr Step kNeighbours[8] = {{1, 0},  {1, 1},   {0, 1},  {-1, 1},
                                 {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};

// Below zero: 1, else 0.
int is_negative(int v) { return static_cast<int>(static_cast<unsigned>(v) >> 31); }

// Octant of a direction: 0 east, 2 south, 4 west, 6 north. Borders at 22.5 degrees (tan = 106/256).
int octant(int dx, int dy) {
  const int ax = hidden(dx < 0 ? -dx : dx), ay = hidden(dy < 0 ? -dy : dy);
  // From east to south, then mirrored at the y axis and at the x axis.
  const int corner = 1 + is_negative(256 * ax - 106 * ay) - is_negative(256 * ay - 106 * ax);
  const int half = dx < 0 ? 4 - corner : corner;
  return (dy < 0 ? -half : half) & 7;
}

// Octant of the isophote at a gradient, along it (sign 1) or against it (-1): a quarter turn from
// the gradient's own.
int octant_ahead(const EdgePixel& p, int sign) { return (octant(p.gx, p.gy) + 2 * sign) & 7; }

Pair gradient_of(const EdgePixel& p) { return load(&p.gx); }
static_assert(offsetof(EdgePixel, gy) == offsetof(EdgePixel, gx) + 2);

std::int32_t dot(Pair p, Pair q) { return add_products(p, q, 0); }

// Gradients of one edge agree within 60 degrees: 4 dot^2 > |p|^2 |q|^2, each below 2^29.
bool agrees(Pair p, std::int32_t square_of_p, Pair q) {
  const std::int32_t twice = 2 * dot(p, q);
  return twice > 0 && std::int64_t{twice} * twice > std::int64_t{square_of_p} * dot(q, q);
}

int magnitude_of(Pair gradient) { return add_products(absolute_pair(gradient), both(1), 0); }

// Edge pixels among the three cells ahead, clockwise.
class Ahead {
 public:
  Ahead(const EdgeMap& map, const ChainSet& set)
      : pixels_(map.pixels.data()),
        starts_(map.block_start.data()),
        row_of_(set.row_of.data()),
        shift_(map.block_shift),
        pixel_count_(map.count) {}

  const std::uint16_t* begin() const { return found_; }
  const std::uint16_t* end() const { return found_ + count_; }

  // Those of the three neighbours of cell (x, y) in octant `ahead` and to both sides of it. `i` is
  // the edge pixel of that cell, or kNoEdge.
  [[gnu::noinline]] void look(int ahead, int x, int y, int i) {
    count_ = 0;
    switch (ahead) {
      case 0:
        look_up(x + 1, 1, y - 1);
        look_beside(x, y, 1, i);
        return look_down(x + 1, 1, y + 1);
      case 1:
        look_beside(x, y, 1, i);
        return look_down(x, 2, y + 1);
      case 2:
        return look_down(x - 1, 3, y + 1);
      case 3:
        look_down(x - 1, 2, y + 1);
        return look_beside(x, y, -1, i);
      case 4:
        look_down(x - 1, 1, y + 1);
        look_beside(x, y, -1, i);
        return look_up(x - 1, 1, y - 1);
      case 5:
        look_beside(x, y, -1, i);
        return look_up(x - 1, 2, y - 1);
      case 6:
        return look_up(x - 1, 3, y - 1);
      default:
        look_up(x, 2, y - 1);
        return look_beside(x, y, 1, i);
    }
  }

 private:
  void add(int i) { found_[count_++] = static_cast<std::uint16_t>(i); }

  // Adds those of the cells x..x + cells - 1 of row y that are edge pixels, from left to right.
  [[gnu::noinline]] void look_up(int x, int cells, int y) {
    const std::uint16_t* const row = starts_ + y * kBlocksPerRow;
    const EdgePixel *p = pixels_ + row[x >> shift_], *const row_end = pixels_ + row[kBlocksPerRow];
    const int first = x << 6, behind = (x + cells) << 6;
    while (p != row_end && p->x_and_offset < first) ++p;
    for (; p != row_end && p->x_and_offset < behind; ++p) add(static_cast<int>(p - pixels_));
  }

  // The same from right to left.
  [[gnu::noinline]] void look_down(int x, int cells, int y) {
    const std::uint16_t* const row = starts_ + y * kBlocksPerRow;
    const EdgePixel *const begin = pixels_ + row[x >> shift_], *const row_end =
                                                                   pixels_ + row[kBlocksPerRow];
    const int first = x << 6, behind = (x + cells) << 6;
    const EdgePixel* p = begin;
    while (p != row_end && p->x_and_offset < behind) ++p;
    while (p != begin && (--p)->x_and_offset >= first) add(static_cast<int>(p - pixels_));
  }

  // The neighbour in the same row, to the right (dx 1) or to the left (-1), whose place in the map
  // is the next one. At the map's ends the pixel itself is looked at.
  [[gnu::noinline]] void look_beside(int x, int y, int dx, int i) {
    if (i == kNoEdge) return look_up(x + dx, 1, y);
    const int other = i + dx >= 0 && i + dx < pixel_count_ ? i + dx : i;
    if (pixels_[other].x() == x + dx && row_of_[other] == y) add(other);
  }

  const EdgePixel* const pixels_;
  const std::uint16_t* const starts_;
  const std::uint16_t* const row_of_;
  const int shift_, pixel_count_;
  int count_ = 0;
  std::uint16_t found_[3] = {};
};

// How far beyond a turnoff a walk may have gone when it comes to nothing and goes back to it: the
// ridge of a corner, or of two maxima side by side, juts out by a pixel or two.
constexpr int kSpurPixels = 2;

// Edge pixels keep clear of the grid's border, so that cells two away are always inside it.
class Linker {
 public:
  Linker(const EdgeMap& map, ChainSet& set, const Work& work)
      : pixels_(map.pixels.data()),
        ahead_(map, set),
        count_(map.count),
        row_of_(set.row_of.data()),
        visited_(set.visited.data()),
        order_(set.order.data()),
        most_looks_(work.left() / kStepsPerLook) {}

  bool is_spent() const { return looks_ >= most_looks_; }
  std::uint32_t steps() const { return looks_ * kStepsPerLook; }  // of work
  int looks_from_pixels() const { return static_cast<int>(looks_ - looks_across_); }

  bool is_visited(int i) const { return (visited_[i >> 5] >> (i & 31) & 1u) != 0; }

  // The first unvisited pixel from `i` on, at least the count where there is none.
  int next_unvisited(int i) const {
    while (i < count_) {
      const std::uint32_t unvisited = ~visited_[i >> 5] >> (i & 31);
      if (unvisited != 0) return i + __builtin_ctz(unvisited);
      i = (i | 31) + 1;
    }
    return i;
  }

  void visit(int i) { visited_[i >> 5] |= 1u << (i & 31); }

  // Walk from pixel `i` along the isophote (sign +1) or against it (-1), appending to `order`.
  // Bounded: every step visits a pixel.
  int walk(int i, int sign, int length) {
    Turnoff turnoff;
    for (int steps = 0; steps < count_ && looks_ < most_looks_; ++steps) {
      Choice next = take_best_ahead(i, sign);
      if (next.best == kNone && length - turnoff.length <= kSpurPixels) {
        next = go_back(turnoff, sign, length);
      }
      if (next.best == kNone) next.best = step_over_gap(i, sign);
      if (next.best == kNone) return length;
      order_[length++] = next.best;
      i = next.best;
      if (next.second != kNone) turnoff = {next.second, length};
    }
    return length;
  }

 private:
  static constexpr std::uint16_t kNone = 65535;  // no pixel has this number

  // Two neighbours ahead, the stronger first: one register.
  struct Choice {
    std::uint16_t best = kNone, second = kNone;
  };

  // A neighbour that was not taken, and the chain's length with the one that was.
  struct Turnoff {
    int pixel = kNone, length = 0;
  };

  // The strongest unvisited neighbours ahead; all candidates ahead become visited.
  [[gnu::noinline]] Choice take_best_ahead(int i, int sign) {
    ++looks_;
    int best = kNone, second = kNone;
    int largest = 0, next = 0;  // magnitudes
    for_each_ahead<0>(i, sign, [&](int candidate, int magnitude) {
      visit(candidate);
      if (magnitude > largest) {
        second = best;
        best = candidate;
        next = largest;
        largest = magnitude;
      } else if (magnitude > next) {
        second = candidate;
        next = magnitude;
      }
    });
    return {static_cast<std::uint16_t>(best), static_cast<std::uint16_t>(second)};
  }

  // Give the weaker neighbour its chance. If it leads on, it takes the place of the stronger one
  // and of what followed it.
  Choice go_back(Turnoff& turnoff, int sign, int& length) {
    if (turnoff.pixel == kNone) return {};
    const Choice next = take_best_ahead(turnoff.pixel, sign);
    if (next.best != kNone) {
      length = turnoff.length;
      order_[length - 1] = static_cast<std::uint16_t>(turnoff.pixel);
    }
    turnoff = {};
    return next;
  }

  [[gnu::noinline]] std::uint16_t step_over_gap(int i, int sign) {
    int best = kNone, largest = 0;
    ++looks_;
    ++looks_across_;
    for_each_ahead<1>(i, sign, [&](int candidate, int magnitude) {
      if (magnitude <= largest) return;
      best = candidate;
      largest = magnitude;
    });
    if (best != kNone) visit(best);
    return static_cast<std::uint16_t>(best);
  }

  // Calls f(pixel, its magnitude) for those of the three neighbours ahead that are unvisited and
  // whose gradient agrees, or for the three that lie `on` a cell further.
  template <int kOn, typename F>
  [[gnu::always_inline]] void for_each_ahead(int i, int sign, F f) {
    const EdgePixel& from = pixels_[i];
    const Pair p = gradient_of(from);
    const std::int32_t square = dot(p, p);
    const int ahead = octant_ahead(from, sign);
    const Step on = kOn != 0 ? kNeighbours[ahead] : Step{0, 0};
    ahead_.look(ahead, from.x() + on.dx, row_of_[i] + on.dy, kOn != 0 ? kNoEdge : i);
    for (const int candidate : ahead_) {
      if (is_visited(candidate)) continue;
      const Pair q = gradient_of(pixels_[candidate]);
      if (agrees(p, square, q)) f(candidate, magnitude_of(q));
    }
  }

  const EdgePixel* const pixels_;
  Ahead ahead_;
  const int count_;
  const std::uint16_t* const row_of_;
  std::uint32_t* const visited_;
  std::uint16_t* const order_;
  const std::uint32_t most_looks_;
  std::uint32_t looks_ = 0, looks_across_ = 0;  // all, those across a gap
};

void reverse(std::uint16_t* begin, std::uint16_t* end) {
  while (begin < end) {
    const std::uint16_t swap = *--end;
    *end = *begin;
    *begin++ = swap;
  }
}

void fill_rows(const EdgeMap& map, std::uint16_t* row_of) {
  const std::uint16_t* row_end = map.block_start.data() + kBlocksPerRow;
  const std::uint16_t* const begin = row_of;
  for (int y = 0; y < map.height; ++y, row_end += kBlocksPerRow) {
    for (const std::uint16_t* const end = begin + *row_end; row_of < end;) {
      *row_of++ = static_cast<std::uint16_t>(y);
    }
  }
}

void clear_marks(int pixels, std::uint32_t* visited) {
  for (int w = 0; w < (pixels + 31) / 32; ++w) visited[w] = 0;
}

}  // namespace

void link_edges(const EdgeMap& map, int anchor_threshold, ChainSet& set, Work& work) {
  set.count = 0;
  set.steps = 0;
  set.pool_full = false;
  clear_marks(map.count, set.visited.data());
  if (!work.take(static_cast<std::uint32_t>(map.count) * kStepsPerPixel)) return;
  fill_rows(map, set.row_of.data());
  Linker linker(map, set, work);
  const EdgePixel* const pixels = map.pixels.data();
  std::uint16_t* const order = set.order.data();
  int used = 0;
  for (int anchor = 0; !linker.is_spent(); ++anchor) {
    anchor = linker.next_unvisited(anchor);
    if (anchor >= map.count) break;
    if (magnitude_of(gradient_of(pixels[anchor])) < anchor_threshold) continue;
    linker.visit(anchor);
    int end = linker.walk(anchor, -1, used);
    reverse(order + used, order + end);
    order[end++] = static_cast<std::uint16_t>(anchor);
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
  set.steps = linker.looks_from_pixels();
  // From here on the bits say which pixels are part of a chain: neither side pixels nor fragments.
  clear_marks(map.count, set.visited.data());
  for (const std::uint16_t* at = order; at != order + used; ++at) linker.visit(*at);
}

}  // namespace berth
