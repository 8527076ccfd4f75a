#include "circle/ring_candidates.hpp"

#include <cstddef>

#include "circle/place.hpp"
#include "fixed/roots.hpp"
#include "image/packed.hpp"

namespace berth {
namespace {

constexpr std::uint32_t kStepsPerFit = 5800, kStepsPerRow = 60, kStepsPerLook = 17;
constexpr std::uint32_t kStepsPerHit = 190, kStepsPerArcPlace = 60;
constexpr int kOne = 4096;  // 1 in frame coordinates, 12 fraction bits

std::int32_t absolute(std::int32_t v) { return v < 0 ? -v : v; }

struct Box {
  int x0, y0, x1, y1;  // cells, inclusive
};

Box clip(const EdgeMap& map, int x0, int y0, int x1, int y1) {
  return {x0 < 0 ? 0 : x0, y0 < 0 ? 0 : y0, x1 < map.width ? x1 : map.width - 1,
          y1 < map.height ? y1 : map.height - 1};
}

Box box_around(const EdgeMap& map, const Ellipse& e, Px half_width, Px half_height) {
  const int cx = e.cx.round(), cy = e.cy.round();
  const int w = half_width.round() + 2, h = half_height.round() + 2;
  return clip(map, cx - w, cy - h, cx + w, cy + h);
}

std::int32_t squared(const FramePoint& q) { return q.x * q.x + q.y * q.y; }

// Squares from least to least + range: distances of points in a frame.
struct Band {
  std::int32_t least, range;

  Band(std::int32_t low, std::int32_t high) : least(low * low), range(high * high - least) {}
  bool holds(std::int32_t square) const {
    return static_cast<std::uint32_t>(square - least) <= static_cast<std::uint32_t>(range);
  }
};

bool is_in_band(const FramePoint& q, const Band& band) {
  if (q.x > 2 * kOne || q.x < -2 * kOne || q.y > 2 * kOne || q.y < -2 * kOne) return false;
  return band.holds(squared(q));
}

// Half a cell along an axis, in the frame of an ellipse.
std::int32_t half_cell_in(const EllipseFrame& f) {
  const std::int32_t along_x = absolute(f.m[0][0]) + absolute(f.m[1][0]);
  const std::int32_t along_y = absolute(f.m[0][1]) + absolute(f.m[1][1]);
  return ((along_x > along_y ? along_x : along_y) * 32 >> 10) + 2;
}

// Is the gradient the inward normal -M^T q within the angle whose squared cosine is given (Q8)?
// Ranges: |M| |q| <= 1.3 / 4 gives |n| < 2^14.4, with |g| < 2^14.1 dot, |n|^2 and |g|^2 stay below
// 2^29 and their products below 2^58.
bool points_inward(const EllipseFrame& f, const FramePoint& q, const EdgePixel& p, int cos2_q8) {
  const std::int32_t nx = (f.m[0][0] * q.x + f.m[1][0] * q.y) >> 12;
  const std::int32_t ny = (f.m[0][1] * q.x + f.m[1][1] * q.y) >> 12;
  const std::int32_t dot = nx * p.gx + ny * p.gy;
  if (dot >= 0) return false;
  BERTH_RANGE(nx > -46341 / 2 && nx < 46341 / 2 && ny > -46341 / 2 && ny < 46341 / 2);
  const std::int32_t nn = nx * nx + ny * ny, gg = p.gx * p.gx + p.gy * p.gy;
  const auto least = static_cast<std::uint64_t>(std::int64_t{nn} * gg) >> 16;
  return static_cast<std::uint64_t>(std::int64_t{dot} * dot) >> 8 >
         least * static_cast<std::uint32_t>(cos2_q8);
}

// Which pixels belong to an outline, by their place and gradient in its frame.
struct Gate {
  std::int32_t low, high;  // |q|, 12 fraction bits: below 1.3, about circles of 10 cells below 2.6
  int cos2_q8;             // of the angle between gradient and inward normal
};

// Below zero: 1, else 0.
int is_negative(int v) { return static_cast<int>(static_cast<unsigned>(v) >> 31); }

int sector_of(const FramePoint& q) {
  // Octant, then a quarter of it by the ratio of the coordinates: coverage needs no equal angles.
  const int ax = hidden(absolute(q.x)), ay = hidden(absolute(q.y));
  const int high = ax > ay ? ax : ay, low = 4 * (ax + ay - high);
  const int quarter =
      is_negative(high - low) + is_negative(2 * high - low) + is_negative(3 * high - low);
  return is_negative(q.x) * 16 + is_negative(q.y) * 8 + is_negative(ay - ax) * 4 + quarter;
}

int popcount(std::uint32_t v) {
  int n = 0;
  for (; v != 0; v &= v - 1) ++n;
  return n;
}

constexpr int kBands = 24;  // of |q|, each 1/16 wide, from 1/4
constexpr int kFirstBand = kOne / 4;
constexpr int kBandWidth = kOne / 16;
constexpr int kWideCos2 = 110;  // within 49 degrees: tilt and a centre far off

// Does the pixel's isophote curve about the candidate? Its centre of curvature must lie within 3/4
// of its radius of the candidate's centre (an ellipse's evolute reaches 0.7 radii at 40 degrees of
// tilt), which leaves out straight edges and the rims of smaller and larger things nearby.
bool curves_about(const EdgePixel& p, const Place& at, const CircleCandidate& c) {
  const int radius = p.isophote_radius();
  if (radius <= 0) return false;
  const int norm = static_cast<int>(hypot(p.gx, p.gy));
  const int dx = (at.x >> 6) + radius * p.gx / norm - c.x;
  const int dy = (at.y >> 6) + radius * p.gy / norm - c.y;
  const int reach = radius * 3 / 4 + 2;
  return dx * dx + dy * dy < reach * reach;
}

// What is made of the pixels in a gate: their number, the sectors that they cover in all or band by
// band, and a fit. Where there is a candidate only those that curve about it count.
struct Hits {
  const CircleCandidate* candidate = nullptr;
  EllipseFit* fit = nullptr;
  std::uint32_t* bands = nullptr;  // kBands of them
  std::uint32_t sectors = 0;
  int count = 0;

  void add(const EdgePixel& p, const FramePoint& q, int y) {
    if (candidate != nullptr && !curves_about(p, place_of(p, y), *candidate)) return;
    const std::uint32_t sector = 1u << sector_of(q);
    sectors |= sector;
    ++count;
    if (bands != nullptr) bands[band_of(q)] |= sector;
    if (fit != nullptr) fit->add(q);
  }

 private:
  static int band_of(const FramePoint& q) {
    const std::int32_t s = squared(q);
    int band = 0;
    for (; band + 1 < kBands; ++band) {
      const std::int32_t next = kFirstBand + (band + 1) * kBandWidth;
      if (s < next * next) break;
    }
    return band;
  }
};

// Adds the box's chain pixels in the gate to `hits`. Most pixels are not: they are told by the cell
// they lie in, whose middle is at most half a cell (32 units of `place`) from their edge.
// Semi-axes of 4 cells and more, so |M| <= 2^14, and 2^15 units at most from the centre: places in
// the frame fit 32 bits before they are cut.
[[gnu::noinline]] void gather(const EdgeMap& map, const ChainSet& set, const Box& box,
                              const EllipseFrame& frame, const Gate& gate, Hits& hits, Work& work) {
  const EdgePixel* const pixels = map.pixels.data();
  const std::uint16_t* const starts = map.block_start.data();
  const auto is_member = [members = set.visited.data()](std::ptrdiff_t i) {
    return (members[i >> 5] >> (i & 31) & 1u) != 0;
  };
  const std::int32_t slack = half_cell_in(frame);
  BERTH_RANGE(slack < kOne / 4);  // |M| <= 2^14: at most 724 + 2
  const std::int32_t low = gate.low > slack ? gate.low - slack : 0, high = gate.high + slack;
  const Band rough(low, high), band(gate.low, gate.high);
  // Unsigned, since the parts of a sum may not fit.
  const auto part = [](std::int32_t v) { return static_cast<std::uint32_t>(v); };
  const std::uint32_t xx = part(frame.m[0][0]), xy = part(frame.m[0][1]), cx = part(frame.cx);
  const std::uint32_t yx = part(frame.m[1][0]), yy = part(frame.m[1][1]);
  const int first = box.x0 * 64, behind = (box.x1 + 1) * 64;
  std::uint32_t looked = 0, in_gate = 0;
  for (int y = box.y0; y <= box.y1; ++y) {
    const int end = starts[map.block_index(box.x1, y) + 1];
    const int begin = starts[map.block_index(box.x0, y)];
    looked += static_cast<std::uint32_t>(end - begin);
    const EdgePixel *p = pixels + begin, *last = pixels + end;
    while (p < last && p->x_and_offset < first) ++p;
    while (p < last && last[-1].x_and_offset >= behind) --last;
    const std::uint32_t dy = static_cast<std::uint32_t>(y * 64 - frame.cy);
    const std::uint32_t row_x = xy * dy - xx * cx, row_y = yy * dy - yx * cx;
    for (; p < last; ++p) {
      const std::uint32_t x = p->x_and_offset & ~63u;
      const auto qx = static_cast<std::int32_t>(row_x + xx * x);
      const auto qy = static_cast<std::int32_t>(row_y + yx * x);
      const std::int32_t u = qx >> 10, v = qy >> 10;
      if (!rough.holds(u * u + v * v) || !is_member(p - pixels)) continue;
      const int offset = p->offset();
      const bool is_steep = p->is_steep_in_x();
      const FramePoint q = {(qx + frame.m[0][is_steep ? 0 : 1] * offset) >> 10,
                            (qy + frame.m[1][is_steep ? 0 : 1] * offset) >> 10};
      if (is_in_band(q, band) && points_inward(frame, q, *p, gate.cos2_q8)) {
        hits.add(*p, q, y);
        ++in_gate;
      }
    }
  }
  const std::uint32_t rows = box.y1 >= box.y0 ? static_cast<std::uint32_t>(box.y1 - box.y0 + 1) : 0;
  work.spend(rows * kStepsPerRow + looked * kStepsPerLook + in_gate * kStepsPerHit);
}

// Band of radii (in the start circle's frame) that is covered best: [low, 1.4 low].
int best_band(const EdgeMap& map, const ChainSet& set, const Box& box, const EllipseFrame& frame,
              const CircleCandidate& candidate, Work& work) {
  std::uint32_t sectors[kBands] = {};
  Hits hits;
  hits.candidate = &candidate;
  hits.bands = sectors;
  const Gate gate = {kFirstBand, kFirstBand + kBands * kBandWidth - 1, kWideCos2};
  gather(map, set, box, frame, gate, hits, work);
  int best = -1, best_cover = 5;
  for (int band = 0; band < kBands; ++band) {
    const int last = band + (band + 4) * 2 / 5;  // radius (band + 4) / 16, up to 1.4 of it
    std::uint32_t covered = 0;
    for (int b = band; b <= last && b < kBands; ++b) covered |= sectors[b];
    if (popcount(covered) > best_cover) {
      best = band;
      best_cover = popcount(covered);
    }
  }
  return best;
}

// A fit to the pixels in the gate; false as well when they cover fewer than `min_covered` sectors.
bool fit_once(const EdgeMap& map, const ChainSet& set, const Box& box, const Gate& gate,
              int min_covered, Ellipse& ellipse, Work& work) {
  const EllipseFrame frame(ellipse);
  EllipseFit fit;
  Hits hits;
  hits.fit = &fit;
  gather(map, set, box, frame, gate, hits, work);
  work.spend(kStepsPerFit);
  return popcount(hits.sectors) >= min_covered && fit.solve(frame, ellipse);
}

// The first fit: of pixels that curve about the candidate, in the best-covered band.
bool fit_first(const EdgeMap& map, const ChainSet& set, const CircleCandidate& candidate,
               Ellipse& ellipse, Work& work) {
  const Px radius(2 * candidate.radius_min);
  ellipse = Ellipse::circle(Px(candidate.x), Px(candidate.y), radius);
  const Px reach = Px::from_raw(radius.raw() / 4 * 7);
  const Box box = box_around(map, ellipse, reach, reach);
  const EllipseFrame frame(ellipse);
  const int band = best_band(map, set, box, frame, candidate, work);
  if (band < 0) return false;
  const std::int32_t low = kFirstBand + band * kBandWidth;
  EllipseFit fit;
  Hits hits;
  hits.candidate = &candidate;
  hits.fit = &fit;
  gather(map, set, box, frame, {low, low * 3 / 2, kWideCos2}, hits, work);
  return fit.solve(frame, ellipse);
}

void measure_support(const EdgeMap& map, const ChainSet& set, const Gate& gate, RingCandidate& ring,
                     Work& work) {
  const EllipseFrame frame(ring.ellipse);
  const Box box = box_around(map, ring.ellipse, ring.axes.half_width, ring.axes.half_height);
  Hits hits;
  gather(map, set, box, frame, gate, hits, work);
  ring.pixels = static_cast<std::int16_t>(hits.count);
  ring.covered = static_cast<std::int16_t>(popcount(hits.sectors));
}

// Gate of `cells` cells about the outline, at least 2.5 % of its minor radius.
Gate narrow_gate(const EllipseAxes& axes, int half_cells) {
  std::int32_t tolerance =
      half_cells * kOne / 2 / (axes.minor.round() > 0 ? axes.minor.round() : 1);
  if (tolerance < kOne / 40) tolerance = kOne / 40;
  if (tolerance > kOne / 4) tolerance = kOne / 4;
  return {kOne - tolerance, kOne + tolerance, 190};  // within 30 degrees
}

// Gates of the fits, in half cells to either side: wide about a circle's fit, narrow about an
// arc's.
constexpr int kCoarseHalfCells[] = {16, 8, 5, 3};
constexpr int kFineHalfCells[] = {6, 3};
constexpr int kArcSamples = 16;  // places along an arc that are tested against its ellipse

// Fits to the pixels near ring.ellipse, nearer from fit to fit, then the support.
bool refine_ring(const EdgeMap& map, const ChainSet& set, Span<const int> gates, int min_covered,
                 RingCandidate& ring, Work& work) {
  const Px limit(map.width > map.height ? map.width : map.height);
  ring.covered = ring.pixels = 0;
  for (const int half_cells : gates) {
    if (work.is_spent()) return false;
    if (!measure_axes(ring.ellipse, limit, ring.axes)) return false;
    if (ring.axes.minor < Px(4) || ring.axes.minor.raw() < ring.axes.major.raw() / 3) return false;
    const Gate gate = narrow_gate(ring.axes, half_cells);
    const Px slack = Px(half_cells);
    const Box around =
        box_around(map, ring.ellipse, ring.axes.half_width + slack, ring.axes.half_height + slack);
    if (!fit_once(map, set, around, gate, min_covered * 3 / 4, ring.ellipse, work)) {
      return false;
    }
  }
  if (!measure_axes(ring.ellipse, limit, ring.axes) || ring.axes.minor < Px(4)) return false;
  measure_support(map, set, narrow_gate(ring.axes, 3), ring, work);
  return ring.covered >= min_covered;
}

// Of `samples` places along the arc those that lie within 1.5 cells of the ellipse.
int count_on(const EdgeMap& map, const ChainSet& set, const Arc& arc, const Ellipse& ellipse,
             const EllipseAxes& axes, int samples) {
  const EllipseFrame frame(ellipse);
  const Gate gate = narrow_gate(axes, 3);
  const Band band(gate.low, gate.high);
  int on = 0;
  for (int k = 0; k < samples; ++k) {
    const int i = set.order.data()[arc.start + (arc.count - 1) * k / (samples - 1)];
    const Place at = place_of(map.pixels.data()[i], set.row_of.data()[i]);
    on += is_in_band(frame.map(at.x, at.y), band) ? 1 : 0;
  }
  return on;
}

// The outline near the ellipse of an arc. Not covered at all when there is none. `is_one` tells
// whether all of the arc lies on its ellipse.
void fit_part(const EdgeMap& map, const ChainSet& set, const Arc& arc, int min_covered,
              RingCandidate& ring, bool& is_one, Work& work) {
  ring = RingCandidate{};
  is_one = false;
  if (!fit_arc(map, set, arc, ring.ellipse, work)) return;
  const Px limit(map.width > map.height ? map.width : map.height);
  if (!measure_axes(ring.ellipse, limit, ring.axes)) return;
  work.spend(kArcSamples * kStepsPerArcPlace);
  is_one = count_on(map, set, arc, ring.ellipse, ring.axes, kArcSamples) >= kArcSamples - 1;
  if (!refine_ring(map, set, kFineHalfCells, min_covered, ring, work)) ring.covered = 0;
}

}  // namespace

bool fit_ring(const EdgeMap& map, const ChainSet& set, const CircleCandidate& candidate,
              int min_covered, RingCandidate& ring, Work& work) {
  return fit_first(map, set, candidate, ring.ellipse, work) &&
         refine_ring(map, set, kCoarseHalfCells, min_covered, ring, work);
}

bool fit_ring(const EdgeMap& map, const ChainSet& set, const Arc& arc, int min_covered,
              RingCandidate& ring, Work& work) {
  bool is_one = false;
  fit_part(map, set, arc, min_covered, ring, is_one, work);
  if (is_one || ring.covered >= kWholeSectors) return ring.covered >= min_covered;
  // Where an outline is cut, its arc may run on around a rounded corner, at one end or both.
  const std::uint16_t count = static_cast<std::uint16_t>(arc.count * 2 / 3);
  for (const int skipped : {0, arc.count - count, (arc.count - count) / 2}) {
    if (work.is_spent()) return false;
    Arc part = arc;
    part.start = static_cast<std::uint16_t>(arc.start + skipped);
    part.count = count;
    RingCandidate other;
    fit_part(map, set, part, min_covered, other, is_one, work);
    if (other.covered > ring.covered) ring = other;
  }
  return ring.covered >= min_covered;
}

bool is_explained(const CircleCandidate& c, const RingCandidate& ring) {
  const int major = ring.axes.major.round();
  const int dx = c.x - ring.ellipse.cx.round(), dy = c.y - ring.ellipse.cy.round();
  return ring.covered >= kWholeSectors && major >= c.radius_min && major <= 2 * c.radius_min &&
         16 * (dx * dx + dy * dy) < major * major;
}

bool is_explained(const EdgeMap& map, const ChainSet& set, const Arc& arc,
                  const RingCandidate& ring) {
  return count_on(map, set, arc, ring.ellipse, ring.axes, 5) == 5;
}

bool is_same_ring(const RingCandidate& a, const RingCandidate& b) {
  const Px tolerance = Px::from_raw(b.axes.major.raw() / 8);
  return abs(a.ellipse.cx - b.ellipse.cx) < tolerance &&
         abs(a.ellipse.cy - b.ellipse.cy) < tolerance &&
         abs(a.axes.major - b.axes.major) < tolerance;
}

}  // namespace berth
