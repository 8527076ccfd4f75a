#include "target/line_test.hpp"

#include "fixed/roots.hpp"
#include "fixed/trigonometry.hpp"
#include "target/identify.hpp"

namespace berth {
namespace {

constexpr int kProfile = 19;  // samples across, a sixth of the bar's width apart: +-1.5 widths
constexpr int kCenter = kProfile / 2;
constexpr Angle kMaxTurn = q<28>(0.14);  // 8 degrees: the roll search is right to 2.5

// The bar's own axes in the plate.
struct BarFrame {
  Mm x, y;  // centre
  SinCos direction;
  Mm px(Mm along, Mm across) const { return x + along * direction.cos - across * direction.sin; }
  Mm py(Mm along, Mm across) const { return y + along * direction.sin + across * direction.cos; }
};

Mm fraction_of(Mm length, int numerator, int denominator) {
  return Mm::from_wide(std::int64_t{length.raw()} * numerator / denominator);
}

// How far the bar must rise over its sides: half of the ring's contrast is left of it after any
// blur of the envelope, and 30 % of that in a shadow; and three sigma of a mean of three samples.
Grey least_rise(const ReferenceValues& reference, std::uint16_t noise_q8) {
  const Grey by_contrast = (reference.white - reference.black) / 7;
  const Grey by_noise = 2 * noise_q8 * kGreyOne / 256;
  return by_contrast > by_noise ? by_contrast : by_noise;
}

struct Profile {
  bool is_bar = false;
  int offset = 0;  // of the bright part's centroid from the middle, 1/256 sample
  Grey middle = 0, side = 0;
};

// What lies between is only read where middle and sides show a bar.
Profile measure_profile(const ImageView& image, const Scan& across, Grey least) {
  Grey level[kProfile];
  const auto read = [&](int first, int end) {
    across.read(image, (first - kCenter) * Scan::kStep, end - first, level + first);
  };
  Profile p;
  if (!across.is_inside()) return p;
  read(kCenter - 1, kCenter + 2);
  const int middle = (level[kCenter - 1] + level[kCenter] + level[kCenter + 1]) / 3;
  p.middle = middle;
  read(0, 3);
  const int before = (level[0] + level[1] + level[2]) / 3;
  if (middle - before < least) return p;
  read(kProfile - 3, kProfile);
  const int after = (level[kProfile - 3] + level[kProfile - 2] + level[kProfile - 1]) / 3;
  p.side = before > after ? before : after;
  if (middle - p.side < least) return p;
  read(3, kCenter - 1);
  read(kCenter + 2, kProfile - 3);
  std::int32_t sum = 0, moment = 0;  // below 19 * 4081, 9 times as much
  for (int k = 0; k < kProfile; ++k) {
    // Sides may be of unequal level: take a ramp between them off.
    const int base = (before * (kProfile - 1 - k) + after * k) / (kProfile - 1);
    const int rise = level[k] - base > 0 ? level[k] - base : 0;
    sum += rise;
    moment += rise * (k - kCenter);
  }
  p.is_bar = sum > 0;
  if (p.is_bar) p.offset = moment * 256 / sum;
  return p;
}

// Straight line through the offsets at the stations: value and slope by least squares.
struct OffsetLine {
  int count = 0;
  std::int64_t s1 = 0, sx = 0, sxx = 0, sy = 0, sxy = 0;
  void add(int x, int y) {
    ++count;
    ++s1;
    sx += x;
    sxx += x * x;
    sy += y;
    sxy += std::int64_t{x} * y;
  }
  std::int64_t determinant() const { return s1 * sxx - sx * sx; }
};

// The darkest of three places 0.7 to 1.1 widths beyond an end: the pose may be off by some, and the
// next dot is not far.
Grey darkest_beyond(const TargetView& view, const TargetModel& target, const BarFrame& bar,
                    int side) {
  Grey darkest = 255 * kGreyOne;
  for (int tenths = 7; tenths <= 11; tenths += 2) {
    const Mm beyond =
        fraction_of(target.line_length_mm, 1, 2) + fraction_of(target.line_width_mm, tenths, 10);
    const Mm along = side < 0 ? -beyond : beyond;
    const Grey level = view.at(bar.px(along, Mm(0)), bar.py(along, Mm(0)));
    if (level < darkest) darkest = level;
  }
  return darkest;
}

}  // namespace

LineTest test_line(const TargetView& view, const TargetModel& target,
                   const ReferenceValues& reference, std::uint16_t noise_q8, Mm shift_mm,
                   int least_stations) {
  const BarFrame place{target.line_x_mm, target.line_y_mm, sin_cos(target.line_angle)};
  const BarFrame bar{place.px(Mm(0), shift_mm), place.py(Mm(0), shift_mm), place.direction};
  const Mm step = fraction_of(target.line_width_mm, 1, 6);
  const int half = kLineStations / 2;
  // The outermost stations keep half a width off the ends.
  const Mm reach = fraction_of(target.line_length_mm, 1, 2) - target.line_width_mm;
  // 16 samples across.
  const Mm way = step * Mm(Scan::kStep);
  const Mm way_x = -(way * bar.direction.sin), way_y = way * bar.direction.cos;
  const Grey least = least_rise(reference, noise_q8);
  Grey middles = 0, sides = 0;
  OffsetLine line;
  LineTest result;
  for (int s = -half; s <= half; ++s) {
    // A line of too few stations is none, or of no use.
    if (line.count + half + 1 - s < least_stations) return result;
    ++result.looks;
    const Mm along = fraction_of(reach, s, half);
    const Scan across(view, bar.px(along, Mm(0)), bar.py(along, Mm(0)), way_x, way_y,
                      kCenter * Scan::kStep);
    const Profile p = measure_profile(view.image, across, least);
    if (!p.is_bar) continue;
    line.add(s, p.offset);
    middles += p.middle;
    sides += p.side;
  }
  result.stations = line.count;
  if (line.count < least_stations || line.determinant() == 0) return result;
  // Beyond its ends the plate is black again; blur may leave 60 %. What is much brighter than the
  // bar is a glint, not the bar going on.
  const Grey least_like = (sides + (middles - sides) * 6 / 10) / line.count;
  const Grey most_like = (sides + (middles - sides) * 15 / 10) / line.count;
  for (int side = -1; side <= 1; side += 2) {
    const Grey beyond = darkest_beyond(view, target, bar, side);
    if (beyond > least_like && beyond < most_like) return result;
  }
  // Offset at the middle and slope, in 1/256 sample and per station.
  const std::int64_t value = (line.sxx * line.sy - line.sx * line.sxy) / line.determinant();
  const std::int64_t slope = (line.s1 * line.sxy - line.sx * line.sy) / line.determinant();
  result.offset_mm = shift_mm + Mm::from_wide(value * step.raw() / 256);
  // Across is +90 degrees from along, so a positive slope is a positive turn.
  result.turn = Angle::from_wide((slope * step.raw() * half / 256 * (std::int64_t{1} << 28) /
                                  (reach.raw() > 0 ? reach.raw() : 1)));
  const Mm from_place = abs(result.offset_mm);
  result.cost = static_cast<int>(from_place.raw() / (step.raw() / 43 + 1)) - 64 * line.count;
  const std::int64_t from_center = value < 0 ? -value : value;
  result.is_line = from_center < 3 * 256 && abs(result.turn) < kMaxTurn;
  // 10 % of the bar's distance from the centre is half its width or more.
  result.in_place = result.is_line && from_place < step * Mm(3);
  return result;
}

LineTest find_line(const TargetView& view, const TargetModel& target,
                   const ReferenceValues& reference, std::uint16_t noise_q8) {
  const Mm aside = fraction_of(target.line_width_mm, 6, 10);
  LineTest best;
  int looks = 0;
  for (const Mm shift : {Mm(0), aside, -aside}) {
    const LineTest line = test_line(view, target, reference, noise_q8, shift, kMinLineStations);
    looks += line.looks;
    if (line.is_line && line.stations > best.stations) best = line;
    if (best.stations == kLineStations) break;
  }
  best.looks = looks;
  return best;
}

}  // namespace berth
