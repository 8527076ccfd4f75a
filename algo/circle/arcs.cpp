#include "circle/arcs.hpp"

#include "circle/place.hpp"
#include "image/packed.hpp"

namespace berth {
namespace {

constexpr std::uint32_t kStepsPerPixel = 70, kStepsPerFit = 6500, kStepsPerPoint = 125;
constexpr std::uint32_t kStepsPerExtent = 14;
constexpr int kMaxFitPoints = 64;
// A corner turns by 45 degrees and 2.4 times the stretch's mean more within five pixels. An ellipse
// at 60 degrees of tilt turns 3.1 times its mean at its ends, so that small rings there are not
// cut; and blur rounds the corners of small ones anyway.
constexpr int kCornerPixels = 5;
constexpr int kCornerTurn = 4;
constexpr int kSharpness = 3;
constexpr int kSmallOutline = 48;         // pixels
constexpr std::int32_t kMaxReach = 7800;  // of a point in its circle's frame: sqrt 2 and the rim

// Below zero: 1, else 0.
int is_negative(int v) { return static_cast<int>(static_cast<unsigned>(v) >> 31); }

// Inline: a call would cost a third of it. Gradients of edge pixels, below 2^14.
inline int direction(int gx, int gy) {
  const int ax = hidden(gx < 0 ? -gx : gx), ay = hidden(gy < 0 ? -gy : gy);
  const int high = ax > ay ? ax : ay, low = 256 * (ax + ay - high);
  // tan of 11.25, 22.5 and 33.75 degrees, 8 fraction bits: 0..3 from the nearer axis on.
  const int eighth =
      is_negative(51 * high - low) + is_negative(106 * high - low) + is_negative(171 * high - low);
  // Mirrored at the diagonal, at the y axis and at the x axis.
  return eighth ^ (ax > ay ? 0 : 7) ^ (gx >> 31 & 15) ^ (gy >> 31 & 31);
}

// A difference of directions, -16..15.
int less_than_half(int difference) {
  return static_cast<int>(static_cast<unsigned>(difference) << 27) >> 27;
}
static_assert(kFullTurn == 32);

// Cuts one chain into arcs: climbs while the turn grows, until it has fallen back by kTurnBack.
class ArcCutter {
 public:
  ArcCutter(const EdgeMap& map, const ChainSet& set, Span<Arc> arcs, int& count)
      : map_(map), set_(set), arcs_(arcs), count_(count) {}

  void cut(const Chain& chain) {
    first_ = chain.start;
    bool is_climbing = false;
    int turn = 0;           // since the chain's first pixel, steps
    int low = 0, high = 0;  // of the stretch at hand
    int low_at = 0, high_at = 0;
    int before = direction_at(0);
    for (int i = 1; i < chain.count; ++i) {
      const int direction = direction_at(i);
      // Walking with the bright side at hand about something bright, the direction falls.
      turn += less_than_half(before - direction);
      before = direction;
      if (is_climbing) {
        if (turn > high) {
          high = turn;
          high_at = i;
        } else if (turn <= high - kTurnBack) {
          close(low_at, high_at, high - low);
          is_climbing = false;
          low = turn;
          low_at = i;
        }
      } else if (turn <= low) {
        low = turn;
        low_at = i;
      } else if (turn >= low + kTurnBack) {
        is_climbing = true;
        high = turn;
        high_at = i;
      }
    }
    // Whole and small: its direction wavers by more than that, and its ends look like corners.
    if (turn >= kWholeTurn && chain.count < kSmallOutline) return keep(0, chain.count - 1, turn);
    if (is_climbing) close(low_at, high_at, high - low);
  }

 private:
  int direction_at(int i) const {
    const EdgePixel& p = map_.pixels.data()[set_.order.data()[first_ + i]];
    return direction(p.gx, p.gy);
  }

  // A stretch, cut at its corners.
  [[gnu::noinline]] void close(int low_at, int high_at, int turn) {
    const int count = high_at - low_at + 1;
    if (turn < kMinTurn || count < kMinArcPixels) return;
    const int sharp = kCornerTurn + kSharpness * kCornerPixels * turn / count;
    // Of the last pixels: directions, and turns since the stretch began.
    std::uint8_t directions[kRing];
    std::int16_t turns[kRing];
    int begin = low_at, turn_at_begin = 0, turned = 0;
    for (int i = begin; i <= high_at; ++i) {
      const int direction = direction_at(i);
      if (i > low_at) turned += less_than_half(directions[(i - 1) % kRing] - direction);
      directions[i % kRing] = static_cast<std::uint8_t>(direction);
      turns[i % kRing] = static_cast<std::int16_t>(turned);
      if (i - begin < kCornerPixels) continue;
      const int before = i - kCornerPixels;
      if (less_than_half(directions[before % kRing] - direction) < sharp) continue;
      keep(begin, before, turns[before % kRing] - turn_at_begin);
      begin = i;
      turn_at_begin = turned;
    }
    keep(begin, high_at, turned - turn_at_begin);
  }

  [[gnu::noinline]] void keep(int begin, int end, int turn) {
    if (end - begin + 1 < kMinArcPixels) return;
    if (turn < kMinTurn) return;
    Arc arc;
    arc.start = static_cast<std::uint16_t>(first_ + begin);
    arc.count = static_cast<std::uint16_t>(end - begin + 1);
    arc.turn = static_cast<std::int16_t>(turn);
    insert(arc);
  }

  void insert(const Arc& arc) {
    const int capacity = static_cast<int>(arcs_.size());
    int at = count_ < capacity ? count_++ : capacity;
    if (at == capacity && arcs_[static_cast<std::size_t>(at - 1)].turn >= arc.turn) return;
    if (at == capacity) --at;
    for (; at > 0 && arcs_[static_cast<std::size_t>(at - 1)].turn < arc.turn; --at) {
      arcs_[static_cast<std::size_t>(at)] = arcs_[static_cast<std::size_t>(at - 1)];
    }
    arcs_[static_cast<std::size_t>(at)] = arc;
  }

  static constexpr int kRing = 8;
  static_assert(kRing > kCornerPixels);

  const EdgeMap& map_;
  const ChainSet& set_;
  Span<Arc> arcs_;
  int& count_;
  int first_ = 0;
};

struct Extent {
  int x0 = 65535, y0 = 65535, x1 = 0, y1 = 0;
  void add(int x, int y) {
    if (x < x0) x0 = x;
    if (x > x1) x1 = x;
    if (y < y0) y0 = y;
    if (y > y1) y1 = y;
  }
};

}  // namespace

int direction_of(int gx, int gy) { return direction(gx, gy); }

int find_arcs(const EdgeMap& map, const ChainSet& set, Span<Arc> arcs, Work& work) {
  int count = 0;
  ArcCutter cutter(map, set, arcs, count);
  for (int c = 0; c < set.count && !work.is_spent(); ++c) {
    const Chain& chain = set.chains[static_cast<std::size_t>(c)];
    work.spend(chain.count * kStepsPerPixel);
    cutter.cut(chain);
  }
  return count;
}

bool fit_arc(const EdgeMap& map, const ChainSet& set, const Arc& arc, Ellipse& ellipse,
             Work& work) {
  const int stride = (arc.count + kMaxFitPoints - 1) / kMaxFitPoints;
  work.spend(kStepsPerFit + static_cast<std::uint32_t>(arc.count / stride) * kStepsPerPoint +
             arc.count * kStepsPerExtent);
  const std::uint16_t *const order = set.order.data() + arc.start, *const row_of =
                                                                       set.row_of.data();
  const EdgePixel* const pixels = map.pixels.data();
  Extent extent;
  for (int i = 0; i < arc.count; ++i) extent.add(pixels[order[i]].x(), row_of[order[i]]);
  const int width = extent.x1 - extent.x0, height = extent.y1 - extent.y0;
  const int size = width > height ? width : height;
  ellipse =
      Ellipse::circle(Px::from_raw((extent.x0 + extent.x1) << 15),
                      Px::from_raw((extent.y0 + extent.y1) << 15), Px::from_raw((size + 1) << 15));
  const EllipseFrame frame(ellipse);
  EllipseFit fit;
  for (int i = 0; i < arc.count; i += stride) {
    const int p = order[i];
    const Place at = place_of(pixels[p], row_of[p]);
    const FramePoint q = frame.map(at.x, at.y);
    if (q.x > kMaxReach || q.x < -kMaxReach || q.y > kMaxReach || q.y < -kMaxReach) return false;
    fit.add(q);
  }
  EllipseAxes axes;
  return fit.solve(frame, ellipse) && measure_axes(ellipse, Px(size + 8), axes);
}

}  // namespace berth
