// Trigonometry against double, and its laws.
#include <gtest/gtest.h>

#include <algorithm>

#include "fixed/trigonometry.hpp"
#include "reference.hpp"

namespace berth_test {
namespace {

using berth::Angle;
using berth::Unit;

TEST(Trigonometry, SinCosErrorOverTheWholeDomain) {
  double worst = 0;
  for (std::int64_t raw = INT32_MIN; raw <= INT32_MAX; raw += 1021) {
    const Angle angle = Angle::from_raw(static_cast<std::int32_t>(raw));
    const berth::SinCos s = berth::sin_cos(angle);
    worst = std::max(worst, std::abs(real(s.sin) - std::sin(real(angle))));
    worst = std::max(worst, std::abs(real(s.cos) - std::cos(real(angle))));
  }
  EXPECT_LE(worst * 0x1p30, 1.5);
}

TEST(Trigonometry, SinCosAtTheQuadrants) {
  EXPECT_EQ(berth::sin_cos(Angle(0)).sin, Unit(0));
  EXPECT_EQ(berth::sin_cos(Angle(0)).cos, Unit(1));
  for (int quadrant = -5; quadrant <= 5; ++quadrant) {
    for (int offset = -3; offset <= 3; ++offset) {
      const Angle angle = Angle::from_wide(std::llround(quadrant * M_PI / 2 * 0x1p28) + offset);
      EXPECT_NEAR(real(berth::sin_cos(angle).sin), std::sin(real(angle)), 1.5 * 0x1p-30);
      EXPECT_NEAR(real(berth::sin_cos(angle).cos), std::cos(real(angle)), 1.5 * 0x1p-30);
    }
  }
}

TEST(Trigonometry, Laws) {
  Random random;
  for (int i = 0; i < 100000; ++i) {
    const Angle a = Angle::from_raw(static_cast<std::int32_t>(random.bits() >> 32) / 4);
    const berth::SinCos s = berth::sin_cos(a);
    const berth::SinCos mirrored = berth::sin_cos(-a);
    EXPECT_LE(std::abs(real(s.sin) * real(s.sin) + real(s.cos) * real(s.cos) - 1), 0x1p-28);
    EXPECT_LE(std::abs((s.sin + mirrored.sin).raw()), 1);
    EXPECT_LE(std::abs((s.cos - mirrored.cos).raw()), 1);
    EXPECT_LE(std::abs((berth::atan2(s.sin.raw(), s.cos.raw()) - a).raw()), 2);  // round trip
  }
}

TEST(Trigonometry, ArcTangentErrorForEveryMagnitude) {
  Random random;
  double worst = 0;
  for (int i = 0; i < 1000000; ++i) {
    const std::int32_t y = random.any32(), x = random.any32();
    worst = std::max(worst, std::abs(real(berth::atan2(y, x)) - std::atan2(y, x)));
  }
  EXPECT_LE(worst * 0x1p28, 0.95);
}

TEST(Trigonometry, ArcTangentOnTheAxes) {
  EXPECT_EQ(berth::atan2(0, 0), Angle(0));
  EXPECT_EQ(berth::atan2(0, 7), Angle(0));
  EXPECT_EQ(berth::atan2(0, -7), berth::kPi);
  EXPECT_EQ(berth::atan2(INT32_MIN, 0), -berth::kHalfPi);
  EXPECT_EQ(berth::atan2(INT32_MAX, 0), berth::kHalfPi);
  EXPECT_NEAR(real(berth::atan2(INT32_MIN, INT32_MIN)), -3 * M_PI / 4, 0x1p-28);
}

TEST(Trigonometry, ArcSineAndCosineUpToTheirEnds) {
  double worst = 0;
  for (std::int64_t raw = -(1 << 30); raw <= 1 << 30; raw += 509) {
    const Unit value = Unit::from_raw(static_cast<std::int32_t>(raw));
    worst = std::max(worst, std::abs(real(berth::asin(value)) - std::asin(real(value))));
    worst = std::max(worst, std::abs(real(berth::acos(value)) - std::acos(real(value))));
  }
  EXPECT_LE(worst * 0x1p28, 1.0);
  EXPECT_EQ(berth::acos(Unit::max()), Angle(0));
  EXPECT_EQ(berth::acos(Unit::lowest()), berth::kPi);
  EXPECT_EQ(berth::asin(Unit(1)), berth::kHalfPi);
}

TEST(Trigonometry, ArcTangentGrowsWithTheAngle) {
  std::int32_t last = berth::atan2(-1000000, 1).raw();
  for (std::int32_t y = -1000000; y < 1000000; y += 37) {
    const std::int32_t now = berth::atan2(y, 54321).raw();
    EXPECT_GE(now, last - 1);  // monotone but for one step of rounding
    last = now;
  }
}

}  // namespace
}  // namespace berth_test
