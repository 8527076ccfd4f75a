#include "circle/arcs.hpp"

#include "circle/place.hpp"

namespace berth {
namespace {

constexpr std::uint32_t kStepsPerPixel = 90, kStepsPerFit = 6500, kStepsPerPoint = 160;
constexpr std::uint32_t kStepsPerExtent = 16;
constexpr int kMaxFitPoints = 64;
// A corner turns by 45 degrees and 2.4 times the stretch's mean more within five pixels. An ellipse
// at 60 degrees of tilt turns 3.1 times its mean at its ends, so that small rings there are not
// cut; and blur rounds the corners of small ones anyway.
constexpr int kCornerPixels = 5;
constexpr int kCornerTurn = 4;
constexpr int kSharpness = 3;
constexpr std::int32_t kMaxReach = 7800;  // of a point in its circle's frame: sqrt 2 and the rim

// Cuts one chain into arcs: climbs while the turn grows, until it has fallen back by kTurnBack.
class ArcCutter {
 public:
  ArcCutter(const EdgeMap& map, const ChainSet& set, Span<Arc> arcs, int& count)
      : map_(map), set_(set), arcs_(arcs), count_(count) {}

  void cut(const Chain& chain) {
    first_ = chain.start;
    is_climbing_ = false;
    turn_ = low_ = high_ = 0;
    low_at_ = high_at_ = 0;
    int before = direction_at(0);
    for (int i = 1; i < chain.count; ++i) {
      const int direction = direction_at(i);
      // Walking with the bright side at hand about something bright, the direction falls.
      const int step = (before - direction) & (kFullTurn - 1);
      turn_ += step < kFullTurn / 2 ? step : step - kFullTurn;
      before = direction;
      is_climbing_ ? climb(i) : descend(i);
    }
    if (is_climbing_) close();
  }

 private:
  int direction_at(int i) const {
    const EdgePixel& p = map_[set_.order[static_cast<std::size_t>(first_ + i)]];
    return direction_of(p.gx, p.gy);
  }

  void climb(int i) {
    if (turn_ > high_) {
      high_ = turn_;
      high_at_ = i;
    }
    if (turn_ > high_ - kTurnBack) return;
    close();
    is_climbing_ = false;
    low_ = turn_;
    low_at_ = i;
  }

  void descend(int i) {
    if (turn_ <= low_) {
      low_ = turn_;
      low_at_ = i;
    }
    if (turn_ < low_ + kTurnBack) return;
    is_climbing_ = true;
    high_ = turn_;
    high_at_ = i;
  }

  // The stretch at hand, cut at its corners.
  void close() {
    const int turn = high_ - low_, count = high_at_ - low_at_ + 1;
    if (turn < kMinTurn || count < kMinArcPixels) return;
    const int sharp = kCornerTurn + kSharpness * kCornerPixels * turn / count;
    // Of the last pixels: directions, and turns since the stretch began.
    std::uint8_t directions[kRing];
    std::int16_t turns[kRing];
    int begin = low_at_, turn_at_begin = 0, turned = 0;
    for (int i = begin; i <= high_at_; ++i) {
      const int direction = direction_at(i);
      if (i > low_at_) turned += less_than_half(directions[(i - 1) % kRing] - direction);
      directions[i % kRing] = static_cast<std::uint8_t>(direction);
      turns[i % kRing] = static_cast<std::int16_t>(turned);
      if (i - begin < kCornerPixels) continue;
      const int before = i - kCornerPixels;
      if (less_than_half(directions[before % kRing] - direction) < sharp) continue;
      keep(begin, before, turns[before % kRing] - turn_at_begin);
      begin = i;
      turn_at_begin = turned;
    }
    keep(begin, high_at_, turned - turn_at_begin);
  }

  // A difference of directions, less than half a circle.
  static int less_than_half(int difference) {
    const int step = difference & (kFullTurn - 1);
    return step < kFullTurn / 2 ? step : step - kFullTurn;
  }

  void keep(int begin, int end, int turn) {
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
  bool is_climbing_ = false;
  int turn_ = 0;            // since the chain's first pixel, steps
  int low_ = 0, high_ = 0;  // of the stretch at hand
  int low_at_ = 0, high_at_ = 0;
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

int direction_of(int gx, int gy) {
  const int ax = gx < 0 ? -gx : gx, ay = gy < 0 ? -gy : gy;
  const int high = ax > ay ? ax : ay, low = (ax > ay ? ay : ax) * 256;
  // tan of 11.25, 22.5 and 33.75 degrees, 8 fraction bits.
  const int eighth = (low > 51 * high) + (low > 106 * high) + (low > 171 * high);
  const int quadrant = ax > ay ? eighth : 7 - eighth;  // 0..7 from the x axis to the y axis
  const int half = gx < 0 ? 15 - quadrant : quadrant;
  return gy < 0 ? 31 - half : half;
}

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
  Extent extent;
  for (int i = 0; i < arc.count; ++i) {
    const int p = set.order[static_cast<std::size_t>(arc.start + i)];
    extent.add(map[p].x(), set.row_of[static_cast<std::size_t>(p)]);
  }
  const int width = extent.x1 - extent.x0, height = extent.y1 - extent.y0;
  const int size = width > height ? width : height;
  ellipse =
      Ellipse::circle(Px::from_raw((extent.x0 + extent.x1) << 15),
                      Px::from_raw((extent.y0 + extent.y1) << 15), Px::from_raw((size + 1) << 15));
  const EllipseFrame frame(ellipse);
  EllipseFit fit;
  for (int i = 0; i < arc.count; i += stride) {
    const int p = set.order[static_cast<std::size_t>(arc.start + i)];
    const Place at = place_of(map[p], set.row_of[static_cast<std::size_t>(p)]);
    const FramePoint q = frame.map(at.x, at.y);
    if (q.x > kMaxReach || q.x < -kMaxReach || q.y > kMaxReach || q.y < -kMaxReach) return false;
    fit.add(q);
  }
  EllipseAxes axes;
  return fit.solve(frame, ellipse) && measure_axes(ellipse, Px(size + 8), axes);
}

}  // namespace berth
