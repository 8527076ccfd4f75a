#include "target/roll_search.hpp"

#include "fixed/roots.hpp"
#include "fixed/trigonometry.hpp"

namespace berth {
namespace {

constexpr int kRolls = 72;  // steps of 5 degrees: half the angle under which a dot appears

// Relative levels on one circle about the centre.
struct Circle {
  Mm radius;
  std::int16_t level[3 * kRolls];  // thrice around
  // -kRolls <= index < 2 * kRolls.
  int at(int index) const {
    BERTH_RANGE(index >= -kRolls && index < 2 * kRolls);
    return level[index + kRolls];
  }
};

void sample_circle(const TargetView& view, const ReferenceValues& reference, Mm radius,
                   Circle& circle) {
  circle.radius = radius;
  for (int k = 0; k < kRolls; ++k) {
    const SinCos turn = sin_cos(Angle::from_wide(std::int64_t{kPi.raw()} * 2 * k / kRolls));
    const Grey grey = view.at(radius * turn.cos, radius * turn.sin);
    const int sector = (k * kReferenceSectors + kRolls / 2) / kRolls % kReferenceSectors;
    circle.level[k] = circle.level[k + kRolls] = circle.level[k + 2 * kRolls] =
        narrow<std::int16_t>(relative_level(reference, sector, grey));
  }
}

struct Polar {
  Mm radius;
  int index;  // of its direction, in steps of 2 pi / kRolls: -kRolls / 2 .. kRolls / 2
};

Polar polar(Mm x, Mm y) {
  const Angle a = atan2(y.raw(), x.raw());
  const std::int64_t steps =
      (std::int64_t{a.raw()} * kRolls / 2 + (a.raw() < 0 ? -kPi.raw() : kPi.raw()) / 2) / kPi.raw();
  return {Mm::from_wide(hypot(x.raw(), y.raw())), static_cast<int>(steps)};
}

// Half the angle under which a piece of this size appears from the centre, in steps, at least 1.
int half_steps(Mm half_size, Mm radius) {
  const Angle a = atan2(half_size.raw(), radius.raw());
  const int steps =
      static_cast<int>(std::int64_t{a.raw()} * kRolls / (2 * std::int64_t{kPi.raw()}));
  return steps < 1 ? 1 : steps;
}

// A direction in 0..kRolls - 1 for one between -kRolls and 2 kRolls.
int wrapped(int index) {
  if (index < 0) return index + kRolls;
  return index < kRolls ? index : index - kRolls;
}

// The line: white over the middle of its arc, black everywhere else on its circle.
int line_score(const Circle& circle, int middle, int half_arc) {
  int white = 0, black = 0, blacks = 0;
  const int core = half_arc * 2 / 3;
  for (int k = -core; k <= core; ++k) white += circle.at(middle + k);
  for (int k = half_arc + 3; k < kRolls - half_arc - 2; ++k, ++blacks)
    black += circle.at(middle + k);
  return white / (2 * core + 1) - (blacks > 0 ? black / blacks : 0);
}

// A dot: white at its place, black on both sides.
int dot_score(const Circle& circle, int middle, int clear) {
  return circle.at(middle) - (circle.at(middle - clear) + circle.at(middle + clear)) / 2;
}

}  // namespace

RollScore search_roll(const TargetView& view, const TargetModel& target,
                      const ReferenceValues& reference) {
  const Polar line = polar(target.line_x_mm, target.line_y_mm);
  // Where the circle leaves the bar: sqrt(inner edge^2 + s^2) = radius.
  const Mm half_width = Mm::from_raw(target.line_width_mm.raw() / 2);
  const Mm inner = line.radius - half_width;
  const std::uint64_t r2 =
      static_cast<std::uint64_t>(std::int64_t{line.radius.raw()} * line.radius.raw());
  const std::uint64_t i2 = static_cast<std::uint64_t>(std::int64_t{inner.raw()} * inner.raw());
  const int half_arc = half_steps(Mm::from_wide(isqrt(r2 - i2)), line.radius);

  Circle line_circle, dot_circle;
  sample_circle(view, reference, line.radius, line_circle);
  dot_circle.radius = Mm(0);
  int scores[kRolls];
  for (int roll = 0; roll < kRolls; ++roll) {
    scores[roll] = 2 * line_score(line_circle, wrapped(line.index + roll), half_arc);
  }
  int weight = 2;
  for (int d = 0; d < target.dot_count; ++d) {
    const Dot& dot = target.dots[d];
    const Polar place = polar(dot.center_mm[0], dot.center_mm[1]);
    // Dots near the axis or off the plate say nothing of the roll (D0), or not where (raised).
    if (dot.center_mm[2].raw() != 0 || place.radius < target.ring_outer_mm) continue;
    if (place.radius != dot_circle.radius) sample_circle(view, reference, place.radius, dot_circle);
    const int clear =
        half_steps(Mm::from_wide(std::int64_t{dot.radius_mm.raw()} * 5 / 2), place.radius);
    for (int roll = 0; roll < kRolls; ++roll) {
      scores[roll] += dot_score(dot_circle, wrapped(place.index + roll), clear);
    }
    ++weight;
  }
  int best = 0;
  for (int roll = 1; roll < kRolls; ++roll) {
    if (scores[roll] > scores[best]) best = roll;
  }
  RollScore result;
  result.score = scores[best] / weight;
  // (-pi, pi], so that later corrections stay in range.
  const int centred = best > kRolls / 2 ? best - kRolls : best;
  result.angle = Angle::from_wide(std::int64_t{kPi.raw()} * 2 * centred / kRolls);
  return result;
}

}  // namespace berth
