// Scaled: relative errors against long double, ends of its range, order.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "fixed/scaled.hpp"

namespace berth {
namespace {

long double real(const Scaled& s) {
  if (s.is_zero()) return 0;
  const int fraction = 60 - s.log2();
  return std::ldexp(static_cast<long double>(s.to_raw(fraction)), -fraction);
}

class ScaledLaws : public testing::Test {
 protected:
  Scaled draw() {
    std::uniform_int_distribution<int> exponent(-80, 80);
    const auto raw = static_cast<std::int64_t>(random_() >> 2) - (std::int64_t{1} << 61);
    return Scaled::from_raw(raw, 61 + exponent(random_));
  }
  std::mt19937_64 random_{3};
};

TEST_F(ScaledLaws, RelativeErrorIsBelow2ToMinus58) {
  const long double bound = std::ldexp(1.0L, -58);
  for (int i = 0; i < 200000; ++i) {
    const Scaled a = draw(), b = draw();
    const long double x = real(a), y = real(b);
    ASSERT_LE(std::abs(real(a * b) - x * y), bound * std::abs(x * y));
    ASSERT_LE(std::abs(real(a + b) - (x + y)), bound * std::max(std::abs(x), std::abs(y)));
    ASSERT_LE(std::abs(real(a / b) - x / y), bound * std::abs(x / y));
    const long double root = std::sqrt(std::abs(x));
    ASSERT_LE(std::abs(real(sqrt(abs(a))) - root), bound * root);
    ASSERT_EQ(a < b, x < y);
  }
}

TEST_F(ScaledLaws, ZeroIsNeutral) {
  const Scaled a = draw(), zero;
  EXPECT_TRUE((a - a).is_zero());
  EXPECT_TRUE((a * zero).is_zero());
  EXPECT_TRUE(a + zero == a);
  EXPECT_TRUE(zero + a == a);
  EXPECT_TRUE(sqrt(zero).is_zero());
  EXPECT_EQ(zero.to_raw(30), 0);
}

TEST_F(ScaledLaws, ConversionRoundsAndClamps) {
  EXPECT_EQ(Scaled::from_raw(3, 1).to_raw(0), 2);    // 1.5, halves up
  EXPECT_EQ(Scaled::from_raw(-3, 1).to_raw(0), -1);  // -1.5
  EXPECT_EQ(Scaled::from_raw(1, 1000).to_raw(30), 0);
  EXPECT_EQ(Scaled(5).to<30>(), Unit::max());
  EXPECT_EQ(Scaled(-5).to<30>(), Unit::lowest());
  EXPECT_EQ(Scaled(q<18>(-12.75)).to<18>(), q<18>(-12.75));
  EXPECT_EQ(Scaled(12).times_power_of_two(-2).to_raw(0), 3);
}

}  // namespace
}  // namespace berth
