#include "marker/locate_dots.hpp"

#include "fixed/roots.hpp"
#include "fixed/trigonometry.hpp"
#include "image/packed.hpp"
#include "marker/grow_region.hpp"

namespace berth {
namespace {

constexpr std::uint32_t kStepsToProject = 6000, kStepsToFindPeak = 19000;
constexpr std::uint32_t kStepsPerPixel = 7, kStepsPerSmoothPixel = 14;  // of the window

// The projection of a dot: centre and the two columns that map its disc to pixels.
struct DotImage {
  Vec2Px center;
  Px radius;          // the larger of its half-axes, roughly
  Px ax, ay, bx, by;  // pixel offsets of the dot's rim along the target's x and y axis
  std::int64_t area_px = 0;
};

DotImage project_dot(const TargetView& view, const Dot& dot) {
  DotImage d;
  const Vec3Mm c = dot.center_mm;
  d.center = view.pixel(c);
  const Vec2Px a = view.pixel(Vec3Mm(c[0] + dot.radius_mm, c[1], c[2]));
  const Vec2Px b = view.pixel(Vec3Mm(c[0], c[1] + dot.radius_mm, c[2]));
  d.ax = a[0] - d.center[0];
  d.ay = a[1] - d.center[1];
  d.bx = b[0] - d.center[0];
  d.by = b[1] - d.center[1];
  const Px ra = Px::from_wide(hypot(d.ax.raw(), d.ay.raw()));
  const Px rb = Px::from_wide(hypot(d.bx.raw(), d.by.raw()));
  d.radius = ra > rb ? ra : rb;
  const std::int64_t det =
      std::int64_t{d.ax.raw()} * d.by.raw() - std::int64_t{d.ay.raw()} * d.bx.raw();
  d.area_px = shift_round((det < 0 ? -det : det) / 1000 * 3142, 32);
  return d;
}

// Grey at a fraction (Q8) of the rim in direction k of 8, about `center`.
constexpr Unit kHalfRoot = q<30>(0.70710678);
constexpr Unit kEight[8][2] = {
    {Unit(1), Unit(0)},  {kHalfRoot, kHalfRoot},   {Unit(0), Unit(1)},  {-kHalfRoot, kHalfRoot},
    {-Unit(1), Unit(0)}, {-kHalfRoot, -kHalfRoot}, {Unit(0), -Unit(1)}, {kHalfRoot, -kHalfRoot}};

Vec2Px rim_point(const DotImage& d, const Vec2Px& center, int k, int fraction_q8) {
  const auto at = [&](Px a, Px b) {
    const std::int64_t v = (a * kEight[k][0] + b * kEight[k][1]).raw();
    return Px::from_wide(v * fraction_q8 / 256);
  };
  return Vec2Px(center[0] + at(d.ax, d.bx), center[1] + at(d.ay, d.by));
}

// Median of the eight levels around the dot, where the plate (or collar) is black.
Grey surround(const ImageView& image, const DotImage& d, const Vec2Px& center, int fraction_q8) {
  Grey sorted[8];
  for (int k = 0; k < 8; ++k) {
    Grey g = sample(image, rim_point(d, center, k, fraction_q8));
    if (g == kNoGrey) g = 255 * kGreyOne;
    int i = k;
    for (; i > 0 && sorted[i - 1] > g; --i) sorted[i] = sorted[i - 1];
    sorted[i] = g;
  }
  return sorted[2];  // a lower quartile: half of the surround may be something else
}

struct Peak {
  Vec2Px at{Px(0), Px(0)};
  Grey level = kNoGrey;  // mean inside
};

// Where to look about a place: inside the dot, and on the plate around it.
struct Stencil {
  static constexpr int kInside = 5, kAround = 8;
  Vec2Px inside[kInside], around[kAround];

  explicit Stencil(const DotImage& d, int around_q8) {
    const Vec2Px origin(Px(0), Px(0));
    inside[0] = origin;
    for (int k = 1; k < kInside; ++k) inside[k] = rim_point(d, origin, 2 * k - 2, 128);
    for (int k = 0; k < kAround; ++k) around[k] = rim_point(d, origin, k, around_q8);
  }
};

// Bright inside and dark around: mean inside less the mean of the four brightest around. Anything
// that is bright on one side as well, as the background beyond the plate's border, scores low.
// False as well where it cannot score more than `least`, as soon as that is known: of most places a
// few samples are read.
bool measure_spot(const ImageView& image, const Stencil& stencil, const Vec2Px& at, Grey least,
                  Grey& inside, Grey& score) {
  constexpr Grey kWhite = 255 * kGreyOne;
  Grey sum = 0, missing = Stencil::kInside * kWhite;
  for (const Vec2Px& offset : stencil.inside) {
    const Grey g = sample(image, Vec2Px(at[0] + offset[0], at[1] + offset[1]));
    if (g == kNoGrey) return false;
    sum += g;
    missing -= kWhite;
    if (sum + missing < Stencil::kInside * least) return false;  // even with nothing around
  }
  inside = sum / Stencil::kInside;
  Grey brightest[4] = {kNoGrey, kNoGrey, kNoGrey, kNoGrey};  // in descending order
  Grey around = 4 * kNoGrey;                                 // their sum
  for (const Vec2Px& offset : stencil.around) {
    const Grey g = sample(image, Vec2Px(at[0] + offset[0], at[1] + offset[1]));
    if (g <= brightest[3]) continue;
    around += g - brightest[3];
    if (inside - around / 4 <= least) return false;  // what follows only makes it brighter
    int i = 3;
    for (; i > 0 && brightest[i - 1] < g; --i) brightest[i] = brightest[i - 1];
    brightest[i] = g;
  }
  score = inside - around / 4;
  return score > least;
}

// The place most like the dot within a radius of the prediction, in steps of a third of it. Where
// the prediction stands out by `enough` it lies in the dot, and the place is found uphill from it.
// It comes first in any case: where it is right, others are done with at a look inside.
Peak find_peak(const ImageView& image, const DotImage& d, int around_q8, Grey enough, Work& work) {
  constexpr int kReach = 3;
  const Stencil stencil(d, around_q8);
  const Px step = Px::from_raw(d.radius.raw() / 3 + (1 << 15));
  Peak best;
  Grey best_score = 0;
  const auto look_around = [&](const Vec2Px& center, int reach) {
    for (int j = -reach; j <= reach; ++j) {
      for (int i = -reach; i <= reach; ++i) {
        const Vec2Px at(center[0] + Px::from_raw(step.raw() * i),
                        center[1] + Px::from_raw(step.raw() * j));
        Grey inside, score;
        if (!measure_spot(image, stencil, at, best_score, inside, score)) continue;
        best = {at, inside}, best_score = score;
      }
    }
  };
  look_around(d.center, 0);
  if (best_score < enough) {
    if (!work.take(kStepsToFindPeak)) return {};
    look_around(d.center, kReach);
    return best;
  }
  for (int climb = 0; climb < kReach; ++climb) {
    const Vec2Px from = best.at;
    look_around(from, 1);
    if (best.at == from) break;
  }
  return best;
}

struct Moments {
  std::int64_t weight = 0, wx = 0, wy = 0;  // DN * 16, and times pixels from the window's corner
  std::int64_t distance2 = 0;               // sum of squared distances, px^2
};

Window window_around(const ImageView& image, int cx, int cy, int half) {
  Window w{cx - half, cy - half, cx + half, cy + half};
  if (w.x0 < 0) w.x0 = 0;
  if (w.y0 < 0) w.y0 = 0;
  if (w.x1 >= image.width) w.x1 = image.width - 1;
  if (w.y1 >= image.height) w.y1 = image.height - 1;
  return w;
}

// An ellipse 1.4 times the dot, plus a pixel for blur, about a pixel.
class Rim {
 public:
  explicit Rim(const DotImage& d) : grow_q8_(358 + 256 * 65536 / d.radius.raw()) {
    // Inverse of the matrix of the rim's columns, inflated: |q| <= 1 inside. 20 fraction bits, of
    // needles at most 2: with 287 px to all sides sums are below 2^31.
    const std::int64_t det =
        std::int64_t{d.ax.raw()} * d.by.raw() - std::int64_t{d.ay.raw()} * d.bx.raw();
    const std::int64_t whole = (det >> 16) * grow_q8_ / 256;
    const auto inverse = [&](Px v) {
      const std::int64_t q = v.raw() * (std::int64_t{1} << 20) / whole;
      return static_cast<std::int32_t>(q > kMost ? kMost : (q < -kMost ? -kMost : q));
    };
    ix_ = inverse(d.by), iy_ = inverse(-d.bx), jx_ = inverse(-d.ay), jy_ = inverse(d.ax);
    reach_ = static_cast<int>((d.radius.raw() * grow_q8_ >> 24) + 2);
  }
  int reach() const { return reach_; }
  [[gnu::always_inline]] bool contains(int dx, int dy) const {
    const std::int32_t qx = (ix_ * dx + iy_ * dy) >> 8, qy = (jx_ * dx + jy_ * dy) >> 8;
    if (is_beyond(qx) || is_beyond(qy)) return false;
    return qx * qx + qy * qy <= kOne * kOne;
  }

  // Where the rim ends in a row in the direction `way`, from a place near there; beyond `limit`
  // backwards where the row is outside.
  [[gnu::noinline]] int end_of_row(int dy, int at, int way, int limit, int start) const {
    const bool is_in = contains(at, dy);
    const int step = is_in ? way : -way, last = is_in ? limit : start;
    while (at != last && contains(at + step, dy) == is_in) at += step;
    return is_in ? at : at + step;
  }

 private:
  static constexpr std::int32_t kOne = 4096, kMost = 1 << 21;
  static bool is_beyond(std::int32_t q) {
    return static_cast<std::uint32_t>(q) + kOne > static_cast<std::uint32_t>(2 * kOne);
  }
  std::int32_t grow_q8_, ix_ = 0, iy_ = 0, jx_ = 0, jy_ = 0;
  int reach_ = 0;
};

// Rows of a dot that are weighed: of a large one every second or third, as its centroid is the
// start of the outlines' refinement. What noise makes of fewer pixels is in the variance.
constexpr int kRowsPerRadius = 14;

// Of 1..n; for n < 0 less those of n + 1..0.
int sum_of_squares(int n) { return n * (n + 1) * (2 * n + 1) / 6; }

// Pixels first .. last of a row, and their sum by their place: at most 287 of 255, below 2^25.
struct RowSums {
  std::int32_t grey = 0, moment = 0;
};

RowSums sum_row(const std::uint8_t* row, int first, int last) {
  constexpr std::uint32_t kEven = both(0xff);
  RowSums sums;
  int at = first;
  for (; at + 3 <= last; at += 4) {
    const std::uint32_t four = load(row + at);
    const auto grey = static_cast<std::int32_t>(sum_bytes(four));
    sums.grey += grey;
    sums.moment = add_products(four & kEven, 0x00020000, sums.moment + grey * at);
    sums.moment = add_products(four >> 8 & kEven, 0x00030001, sums.moment);
  }
  for (; at <= last; ++at) {
    sums.grey += row[at];
    sums.moment += row[at] * at;
  }
  return sums;
}

// Centroid of grey over black inside the rim.
Moments weigh(const ImageView& image, const DotImage& d, int cx, int cy, Grey black) {
  const Rim rim(d);
  const Window w = window_around(image, cx, cy, rim.reach());
  const int stride = 1 + d.radius.raw() / Px(kRowsPerRadius).raw();
  const int left = w.x0 - cx, right = w.x1 - cx;
  Moments m;
  int first = left, last = right;
  for (int y = w.y0; y <= w.y1; y += stride) {
    const int dy = y - cy;
    // From where the row before begins and ends: the rim is convex.
    first = rim.end_of_row(dy, first, -1, left, right);
    if (first > right) {
      first = left;
      continue;
    }
    last = rim.end_of_row(dy, last > first ? last : first, 1, right, first);
    const int pixels = last - first + 1;
    const std::int32_t distances = (first + last) * pixels / 2;
    const std::int32_t squares = sum_of_squares(last) - sum_of_squares(first - 1);
    RowSums sums = sum_row(image.row(y) + cx, first, last);
    if (image.polarity_mask != 0) {  // 255 less each level
      sums = {255 * pixels - sums.grey, 255 * distances - sums.moment};
    }
    // Of a row: below 2^28 with their distance.
    const std::int32_t weight = sums.grey * kGreyOne - black * pixels;
    const std::int32_t moment = sums.moment * kGreyOne - black * distances;
    m.weight += weight;
    m.wx += moment;
    m.wy += std::int64_t{weight} * dy;
    m.distance2 += squares + std::int64_t{pixels} * dy * dy;
  }
  return m;
}

bool is_like(const Region& region, const DotImage& d) {
  if (region.touches_border || region.area < 6) return false;
  // Blur, saturation and the threshold move the area of a small dot by much.
  const std::int64_t blur_area = d.radius.raw() * 3 / 65536 + 8;
  const std::int64_t largest = d.area_px * 3 / 2 + 2 * blur_area, least = d.area_px / 2 - blur_area;
  if (region.area > largest || region.area < least) return false;
  // An ellipse fills 0.785 of its box when upright; a cut or merged one fills less, or is longer.
  const int w = region.x1 - region.x0 + 1, h = region.y1 - region.y0 + 1;
  return region.area * 100 > w * h * 55 && w < 3 * h && h < 3 * w;
}

// a / b with 24 fraction bits, for 0 <= a < 2^56, 0 < b < 2^62. Coarse where a is large: noise that
// drowns the dot.
std::int64_t ratio_q24(std::int64_t a, std::int64_t b) {
  return a < (std::int64_t{1} << 38) ? a * (1 << 24) / b : a / (b / (1 << 24) + 1);
}

int area_of(const Window& w) { return (w.x1 - w.x0 + 1) * (w.y1 - w.y0 + 1); }

bool is_inside(const Window& w, int x, int y) {
  return x >= w.x0 && x <= w.x1 && y >= w.y0 && y <= w.y1;
}

bool locate(const TargetView& view, const Dot& dot, const ReferenceValues& reference,
            std::uint16_t noise_q8, Marker& marker, Work& work) {
  if (!work.take(kStepsToProject)) return false;
  const DotImage d = project_dot(view, dot);
  if (d.radius < q<16>(1.5) || d.radius > Px(100) || d.area_px < 4) return false;
  const bool has_collar = dot.collar_radius_mm > dot.radius_mm;
  const int around_q8 = has_collar ? 333 : 384;
  const Grey enough = (reference.white - reference.black) * 3 / 4;
  const Peak peak = find_peak(view.image, d, around_q8, enough, work);
  if (peak.level == kNoGrey) return false;
  const Grey black = surround(view.image, d, peak.at, around_q8);
  const Grey contrast = peak.level - black;
  // A shadow leaves 30 % of the light and the gradient a quarter of the contrast. Both levels are
  // means of some nine samples: two sigma of a pixel are five of their difference.
  if (contrast * 16 < (reference.white - reference.black) ||
      contrast < 2 * noise_q8 * kGreyOne / 256) {
    return false;
  }
  // Half-way is six sigma from both levels, or pixels are too noisy one by one.
  const GrowRule rule{(peak.level + black) / 2 / kGreyOne,
                      contrast < 12 * noise_q8 * kGreyOne / 256};
  const int x = peak.at[0].round(), y = peak.at[1].round();
  const Window window =
      window_around(view.image, x, y, static_cast<int>(d.radius.raw() * 9 / 4 / 65536) + 3);
  if (!is_inside(window, x, y)) return false;
  const std::uint32_t steps = rule.smooth ? kStepsPerSmoothPixel : kStepsPerPixel;
  if (!work.take(static_cast<std::uint32_t>(area_of(window)) * steps)) return false;
  const Region region = grow_region(view.image, window, x, y, rule);
  if (!is_like(region, d)) return false;
  const int cx = (region.x0 + region.x1) / 2, cy = (region.y0 + region.y1) / 2;
  const Moments m = weigh(view.image, d, cx, cy, black);
  if (m.weight <= 0) return false;
  marker.center_px[0] = Px::from_wide((std::int64_t{cx} << 16) + m.wx * 65536 / m.weight);
  marker.center_px[1] = Px::from_wide((std::int64_t{cy} << 16) + m.wy * 65536 / m.weight);
  // Noise of the centroid: sigma^2 sum d^2 / weight^2 per axis (half of the sum each), and 0.03 px
  // for what the model leaves out (uneven light, neighbours' blur).
  const std::int64_t sigma = std::int64_t{noise_q8} * kGreyOne / 256 + 1;
  const std::int64_t noise = ratio_q24(sigma * sigma * m.distance2 / 2, m.weight * m.weight + 1);
  const Q<24> variance = Q<24>::saturated(noise + q<24>(0.0009).raw());
  marker.variance_xx = marker.variance_yy = variance;
  marker.variance_xy = Q<24>(0);
  marker.located = true;
  return true;
}

}  // namespace

void locate_dots(const TargetView& view, const TargetModel& target,
                 const ReferenceValues& reference, std::uint16_t noise_q8, MarkerSet& markers,
                 Work& work) {
  markers = MarkerSet{};
  for (int i = 0; i < target.dot_count; ++i) {
    Marker& marker = markers.markers[markers.count++];
    marker.kind = MarkerKind::kDot;
    marker.index = static_cast<std::uint8_t>(i);
    locate(view, target.dots[i], reference, noise_q8, marker, work);
  }
  markers.markers[markers.count++].kind = MarkerKind::kRing;
  markers.markers[markers.count++].kind = MarkerKind::kLine;
}

}  // namespace berth
