#include "circle/votes.hpp"

#include "fixed/roots.hpp"
#include "image/packed.hpp"

namespace berth {
namespace {

struct Octave {
  int radius_min;  // cells, at scale 0
  int cell_shift;  // accumulator cell = 1 << cell_shift grid cells
  int side;        // accumulator cells per row
  int first;       // in VoteSpace::cells
};

constexpr Octave kOctave[kOctaves] = {{5, 2, 128, 0},
                                      {10, 2, 128, 128 * 128},
                                      {20, 3, 64, 2 * 128 * 128},
                                      {40, 4, 32, 2 * 128 * 128 + 64 * 64},
                                      {80, 5, 16, 2 * 128 * 128 + 64 * 64 + 32 * 32}};
constexpr std::uint32_t kStepsPerPixel = 250, kStepsPerVote = 120, kStepsToClear = 40000;
constexpr std::uint32_t kStepsToScan = 130000, kStepsPerBox = 120;
constexpr int kShortHalf = 4;  // half-length of the short stretch, pixels
constexpr int kLongHalf = 12;  // of the long one
constexpr int kMinScore = 10;  // of about 40 votes of a whole circle, spread over the evolute

int absolute(int v) { return v < 0 ? -v : v; }

// |g| to 4 %: max + 0.4 min.
int rough_norm(const EdgePixel& p) {
  const int ax = p.gx < 0 ? -p.gx : p.gx, ay = p.gy < 0 ? -p.gy : p.gy;
  return ax > ay ? (123 * ax + 51 * ay) >> 7 : (123 * ay + 51 * ax) >> 7;
}

// Sums of Lvv and |g| over a stretch of 2 half + 1 pixels that slides along a chain.
class Stretch {
 public:
  Stretch(const EdgeMap& map, const std::uint16_t* order, int count, int half)
      : map_(map), order_(order), count_(count), half_(half) {
    for (int i = 0; i < half && i < count; ++i) add(i, 1);
  }
  // Move the centre to pixel i; called with i = 0, 1, 2, ...
  void advance(int i) {
    if (i + half_ < count_) add(i + half_, 1);
    if (i - half_ - 1 >= 0) add(i - half_ - 1, -1);
  }
  // |sums| < 25 * 2^15 < 2^20.
  int lvv = 0;
  int norm = 0;

 private:
  void add(int i, int sign) {
    const EdgePixel& p = map_[order_[i]];
    lvv += sign * p.lvv;
    norm += sign * rough_norm(p);
  }
  const EdgeMap& map_;
  const std::uint16_t* order_;
  int count_, half_;
};

int octave_of(int radius, int scale_shift) {
  for (int k = 0; k < kOctaves; ++k) {
    const int r0 = kOctave[k].radius_min << scale_shift;
    if (radius >= r0 && radius < 2 * r0) return k;
  }
  return -1;
}

// Radius of curvature in cells, signed (positive: bright inside), 0 where it is out of range.
int signed_radius(const Stretch& s) {
  const int lvv = s.lvv < 0 ? -s.lvv : s.lvv;
  if (lvv == 0) return 0;
  const int radius = s.norm / lvv;
  return s.lvv < 0 ? radius : -radius;
}

void vote(const EdgePixel& p, int y, int radius, int octave, VoteSpace& space) {
  const int norm = static_cast<int>(hypot(p.gx, p.gy));
  if (norm == 0) return;
  const Octave& o = kOctave[octave];
  const int shift = o.cell_shift + space.scale_shift;
  const int cx = (p.x() + radius * p.gx / norm) >> shift;
  const int cy = (y + radius * p.gy / norm) >> shift;
  if (cx < 0 || cy < 0 || cx >= o.side || cy >= o.side) return;
  std::uint8_t& cell = space.cells[o.first + cy * o.side + cx];
  if (cell < 255) ++cell;
  ++space.votes;
}

// Radii wait here until no stretch needs the derivatives in whose place they go.
class DelayedRadii {
 public:
  DelayedRadii(EdgeMap& map, const std::uint16_t* order) : map_(map), order_(order) {}
  void put(int i, int radius) {
    if (i > kLongHalf) store(i - kLongHalf - 1);
    pending_[i % kSlots] = static_cast<std::int16_t>(radius);
  }
  void flush(int count) {
    for (int i = count > kLongHalf ? count - kLongHalf - 1 : 0; i < count; ++i) store(i);
  }

 private:
  static constexpr int kSlots = 16;
  static_assert(kSlots > kLongHalf + 1);
  void store(int i) { map_.pixels[order_[i]].lvv = pending_[i % kSlots]; }
  EdgeMap& map_;
  const std::uint16_t* order_;
  std::int16_t pending_[kSlots] = {};
};

void vote_along(EdgeMap& map, const ChainSet& set, const Chain& chain, VoteSpace& space) {
  const std::uint16_t* order = set.order.data() + chain.start;
  const int count = chain.count;
  Stretch brief(map, order, count, kShortHalf);
  Stretch lengthy(map, order, count, kLongHalf);
  DelayedRadii radii(map, order);
  int travelled = 0;  // in 1/64 of a vote
  for (int i = 0; i < count; ++i) {
    brief.advance(i);
    lengthy.advance(i);
    int radius = signed_radius(lengthy);
    // A stretch that turns by more than about a radian is no arc of one circle any more.
    if (absolute(radius) < 2 * kLongHalf) radius = signed_radius(brief);
    const int octave = octave_of(absolute(radius), space.scale_shift);
    radii.put(i, octave < 0 ? 0 : radius);
    if (octave < 0) continue;
    // A vote each radius_min / 5 pixels: 31 to 63 votes per full circle of any size.
    travelled += 64 * 5;
    const int stride = 64 * (kOctave[octave].radius_min << space.scale_shift);
    if (travelled < stride) continue;
    travelled -= travelled < 2 * stride ? stride : travelled;
    vote(map[order[i]], set.row_of[order[i]], radius, octave, space);
  }
  radii.flush(count);
}

struct Box {
  int sum = 0;
  int mx = 0, my = 0;  // moments about the middle cell
};

Box box_around(const VoteSpace& space, const Octave& o, int x, int y) {
  Box box;
  for (int v = y > 0 ? y - 1 : 0; v <= y + 1 && v < o.side; ++v) {
    for (int u = x > 0 ? x - 1 : 0; u <= x + 1 && u < o.side; ++u) {
      const int votes = space.cells[o.first + v * o.side + u];
      box.sum += votes;
      box.mx += votes * (u - x);
      box.my += votes * (v - y);
    }
  }
  return box;
}

bool is_near(const CircleCandidate& a, const CircleCandidate& b, int reach) {
  const int dx = a.x - b.x, dy = a.y - b.y;
  return a.radius_min == b.radius_min && dx <= reach && -dx <= reach && dy <= reach && -dy <= reach;
}

// Sorted insertion; a weaker neighbour of the same octave gives way, a stronger one wins.
int insert(const CircleCandidate& c, int reach, Span<CircleCandidate> list, int count) {
  for (int i = 0; i < count; ++i) {
    CircleCandidate& other = list[static_cast<std::size_t>(i)];
    if (!is_near(c, other, reach)) continue;
    if (other.score >= c.score) return count;
    for (int k = i; k + 1 < count; ++k) {
      list[static_cast<std::size_t>(k)] = list[static_cast<std::size_t>(k + 1)];
    }
    --count;
    --i;
  }
  const int capacity = static_cast<int>(list.size());
  int at = count < capacity ? count : capacity;
  while (at > 0 && list[static_cast<std::size_t>(at - 1)].score < c.score) --at;
  if (at == capacity) return count;
  if (count < capacity) ++count;
  for (int k = count - 1; k > at; --k) {
    list[static_cast<std::size_t>(k)] = list[static_cast<std::size_t>(k - 1)];
  }
  list[static_cast<std::size_t>(at)] = c;
  return count;
}

}  // namespace

void cast_votes(EdgeMap& map, const ChainSet& set, VoteSpace& space, Work& work) {
  for (std::uint8_t& cell : space.cells) cell = 0;
  space.scale_shift = map.width > 512 || map.height > 512 ? 1 : 0;
  space.votes = 0;
  work.spend(kStepsToClear);
  for (int c = 0; c < set.count && !work.is_spent(); ++c) {
    const Chain& chain = set.chains[static_cast<std::size_t>(c)];
    work.spend(chain.count * kStepsPerPixel);
    vote_along(map, set, chain, space);
  }
  work.spend(static_cast<std::uint32_t>(space.votes) * kStepsPerVote);
}

int find_candidates(const VoteSpace& space, Span<CircleCandidate> candidates, Work& work) {
  int count = 0;
  if (!work.take(kStepsToScan)) return 0;
  for (const Octave& o : kOctave) {
    const int cell = 1 << (o.cell_shift + space.scale_shift);
    for (int y = 0; y < o.side; ++y) {
      for (int x = 0; x < o.side; ++x) {
        const std::uint8_t* const cells = space.cells + o.first + y * o.side + x;
        if (x % 4 == 0 && load(cells) == 0) {
          x += 3;
          continue;
        }
        if (*cells == 0) continue;
        work.spend(kStepsPerBox);
        const Box box = box_around(space, o, x, y);
        if (box.sum < kMinScore) continue;
        CircleCandidate c;
        c.x = static_cast<std::int16_t>(x * cell + cell / 2 + box.mx * cell / box.sum);
        c.y = static_cast<std::int16_t>(y * cell + cell / 2 + box.my * cell / box.sum);
        c.radius_min = static_cast<std::int16_t>(o.radius_min << space.scale_shift);
        c.score = static_cast<std::int16_t>(box.sum);
        count = insert(c, 2 * cell, candidates, count);
      }
    }
  }
  return count;
}

}  // namespace berth
