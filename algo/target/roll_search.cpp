#include "target/roll_search.hpp"

#include "fixed/roots.hpp"
#include "fixed/trigonometry.hpp"

namespace berth {
namespace {

constexpr int kRolls = 72;  // steps of 5 degrees: half the angle under which a dot appears

// Relative levels on one circle about the centre.
struct Circle {
  Mm radius;
  int sum = 0;                     // once around
  std::int16_t level[3 * kRolls];  // thrice around
  // Levels about a direction: -kRolls <= index < 2 * kRolls.
  const std::int16_t* about(int index) const {
    BERTH_RANGE(index >= -kRolls && index < 2 * kRolls);
    return level + kRolls + index;
  }
};

void sample_circle(const TargetView& view, const ReferenceValues& reference,
                   const SinCos (&turns)[kRolls], Mm radius, Circle& circle) {
  circle.radius = radius;
  circle.sum = 0;
  for (int k = 0; k < kRolls; ++k) {
    const Grey grey = view.at(radius * turns[k].cos, radius * turns[k].sin);
    const int sector = (k * kReferenceSectors + kRolls / 2) / kRolls % kReferenceSectors;
    const auto level = narrow<std::int16_t>(relative_level(reference, sector, grey));
    circle.level[k] = circle.level[k + kRolls] = circle.level[k + 2 * kRolls] = level;
    circle.sum += level;
  }
}

struct Polar {
  Mm radius;
  // Of its direction, in steps of 2 pi / kRolls: -kRolls / 2 .. kRolls / 2. With all rolls, and a
  // quarter turn more to both sides, it stays within thrice around.
  int index;
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

// Sum of the levels about directions that follow each other, up to `reach` to both sides.
class Arc {
 public:
  Arc(const std::int16_t* middle, int reach) : middle_(middle), reach_(reach) {
    for (int k = -reach; k <= reach; ++k) sum_ += middle[k];
  }
  int sum() const { return sum_; }
  void advance() {
    sum_ += middle_[reach_ + 1] - middle_[-reach_];
    ++middle_;
  }

 private:
  const std::int16_t* middle_;
  int reach_, sum_ = 0;
};

// The line: white over the middle of its arc, black everywhere else on its circle.
void score_line(const Circle& circle, int middle, int half_arc, int (&scores)[kRolls]) {
  const int core = half_arc * 2 / 3, clear = half_arc + 2;
  const int blacks = kRolls - (2 * clear + 1);
  Arc white(circle.about(middle), core), other(circle.about(middle), clear);
  for (int& score : scores) {
    const int black = blacks > 0 ? (circle.sum - other.sum()) / blacks : 0;
    score = 2 * (white.sum() / (2 * core + 1) - black);
    white.advance();
    other.advance();
  }
}

// A dot: white at its place, black on both sides.
void add_dot(const Circle& circle, int middle, int clear, int (&scores)[kRolls]) {
  const std::int16_t* level = circle.about(middle);
  for (int& score : scores) {
    score += level[0] - (level[-clear] + level[clear]) / 2;
    ++level;
  }
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

  SinCos turns[kRolls];
  for (int k = 0; k < kRolls; ++k) {
    turns[k] = sin_cos(part_of_turn(k, kRolls));
  }
  Circle circle;
  sample_circle(view, reference, turns, line.radius, circle);
  int scores[kRolls];
  score_line(circle, line.index, half_arc, scores);
  int weight = 2;
  for (int d = 0; d < target.dot_count; ++d) {
    const Dot& dot = target.dots[d];
    const Polar place = polar(dot.center_mm[0], dot.center_mm[1]);
    // Dots near the axis or off the plate say nothing of the roll (D0), or not where (raised).
    if (dot.center_mm[2].raw() != 0 || place.radius < target.ring_outer_mm) continue;
    if (place.radius != circle.radius) {
      sample_circle(view, reference, turns, place.radius, circle);
    }
    const int clear =
        half_steps(Mm::from_wide(std::int64_t{dot.radius_mm.raw()} * 5 / 2), place.radius);
    add_dot(circle, place.index, clear, scores);
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
