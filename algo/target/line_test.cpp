#include "target/line_test.hpp"

#include "fixed/roots.hpp"
#include "fixed/trigonometry.hpp"
#include "target/identify.hpp"

namespace berth {
namespace {

constexpr int kProfile = 19;  // samples across, a sixth of the bar's width apart: +-1.5 widths
constexpr int kCenter = kProfile / 2;
constexpr int kMinRise = 90;     // of 256: the bar over its sides, after any blur of the envelope
constexpr int kMaxBeyond = 150;  // beyond its ends the plate is black, but for blur

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

int sector_of(Mm x, Mm y, Angle roll) {
  std::int64_t a = std::int64_t{atan2(y.raw(), x.raw()).raw()} + roll.raw();
  const std::int64_t turn = 2 * std::int64_t{kPi.raw()};
  a += 2 * turn;
  return static_cast<int>((a * kReferenceSectors + turn / 2) / turn) % kReferenceSectors;
}

struct Profile {
  bool is_bar = false;
  int offset = 0;  // of the bright part's centroid from the middle, 1/256 sample
};

Profile measure_profile(const int (&level)[kProfile]) {
  const int middle = (level[kCenter - 1] + level[kCenter] + level[kCenter + 1]) / 3;
  const int before = (level[0] + level[1] + level[2]) / 3;
  const int after = (level[kProfile - 3] + level[kProfile - 2] + level[kProfile - 1]) / 3;
  Profile p;
  if (middle - before < kMinRise || middle - after < kMinRise) return p;
  std::int64_t sum = 0, moment = 0;
  for (int k = 0; k < kProfile; ++k) {
    // Sides may be of unequal level: take a ramp between them off.
    const int base = (before * (kProfile - 1 - k) + after * k) / (kProfile - 1);
    const int rise = level[k] - base > 0 ? level[k] - base : 0;
    sum += rise;
    moment += rise * (k - kCenter);
  }
  p.is_bar = sum > 0;
  if (p.is_bar) p.offset = static_cast<int>(moment * 256 / sum);
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

}  // namespace

LineTest test_line(const TargetView& view, const TargetModel& target,
                   const ReferenceValues& reference, Angle roll) {
  const BarFrame bar{target.line_x_mm, target.line_y_mm, sin_cos(target.line_angle)};
  const Mm step = fraction_of(target.line_width_mm, 1, 6);
  const int half = kLineStations / 2;
  // The outermost stations keep half a width off the ends.
  const Mm reach = fraction_of(target.line_length_mm, 1, 2) - target.line_width_mm;
  const int sector = sector_of(bar.x, bar.y, roll);
  OffsetLine line;
  LineTest result;
  for (int s = -half; s <= half; ++s) {
    const Mm along = fraction_of(reach, s, half);
    int level[kProfile];
    for (int k = 0; k < kProfile; ++k) {
      const Mm across = fraction_of(step, k - kCenter, 1);
      level[k] =
          relative_level(reference, sector, view.at(bar.px(along, across), bar.py(along, across)));
    }
    const Profile p = measure_profile(level);
    if (p.is_bar) line.add(s, p.offset);
  }
  result.stations = line.count;
  if (line.count < 3 || line.determinant() == 0) return result;
  const Mm beyond =
      fraction_of(target.line_length_mm, 1, 2) + fraction_of(target.line_width_mm, 9, 10);
  for (int side = -1; side <= 1; side += 2) {
    const Mm along = side < 0 ? -beyond : beyond;
    const int level =
        relative_level(reference, sector, view.at(bar.px(along, Mm(0)), bar.py(along, Mm(0))));
    if (level > kMaxBeyond) return result;
  }
  // Offset at the middle and slope, in 1/256 sample and per station.
  const std::int64_t value = (line.sxx * line.sy - line.sx * line.sxy) / line.determinant();
  const std::int64_t slope = (line.s1 * line.sxy - line.sx * line.sy) / line.determinant();
  result.offset_mm = Mm::from_wide(value * step.raw() / 256);
  // Across is +90 degrees from along, so a positive slope is a positive turn.
  result.turn = Angle::from_wide((slope * step.raw() * half / 256 * (std::int64_t{1} << 28) /
                                  (reach.raw() > 0 ? reach.raw() : 1)));
  const std::int64_t size = value < 0 ? -value : value;
  result.cost = static_cast<int>(size / 6) - 64 * line.count;
  // 10 % of the bar's distance from the centre is half its width or more: no further off than that.
  result.is_line = size < 3 * 256;
  return result;
}

}  // namespace berth
