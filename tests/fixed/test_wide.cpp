// 128-bit products and quotients against the compiler's __int128.
#include <gtest/gtest.h>

#include "fixed/wide.hpp"
#include "reference.hpp"

namespace berth_test {
namespace {

__extension__ using Int128 = __int128;
__extension__ using Unsigned128 = unsigned __int128;

Unsigned128 absolute(Int128 value) {
  return value < 0 ? -static_cast<Unsigned128>(value) : static_cast<Unsigned128>(value);
}

TEST(Wide, ProductsEqual128BitArithmetic) {
  Random random;
  int compared = 0;
  for (int i = 0; i < 400000; ++i) {
    const std::int64_t a = random.any64(), b = random.any64();
    const int shift = static_cast<int>(random.bits() % 127);
    const Int128 product = static_cast<Int128>(a) * b;
    Unsigned128 rounded = absolute(product);
    if (shift > 0) rounded = (rounded + (Unsigned128{1} << (shift - 1))) >> shift;
    if ((rounded >> 63) != 0) continue;
    const auto expected = static_cast<std::int64_t>(rounded);
    EXPECT_EQ(berth::mul_shift(a, b, shift), product < 0 ? -expected : expected);
    ++compared;
  }
  EXPECT_GT(compared, 200000);
}

TEST(Wide, QuotientsEqual128BitArithmetic) {
  Random random;
  int compared = 0;
  for (int i = 0; i < 400000; ++i) {
    const std::int64_t a = random.any64(), b = random.any64();
    const int shift = static_cast<int>(random.bits() % 64);
    if (b == 0) continue;
    const Unsigned128 divisor = absolute(b);
    const Unsigned128 rounded = ((absolute(a) << shift) + divisor / 2) / divisor;
    if ((rounded >> 63) != 0) continue;
    const auto expected = static_cast<std::int64_t>(rounded);
    EXPECT_EQ(berth::div_shift(a, shift, b), (a < 0) != (b < 0) ? -expected : expected);
    ++compared;
  }
  EXPECT_GT(compared, 200000);
}

TEST(Wide, QuotientDigitsAtTheirLimits) {
  // Estimates of a digit that are one and two too large (Knuth 4.3.1, exercise 21).
  const std::uint64_t divisors[] = {0x8000000000000001u, 0x80000000ffffffffu, 0xffffffffffffffffu,
                                    0x8000000100000000u, 3u};
  for (const std::uint64_t d : divisors) {
    for (const std::uint64_t high : {d - 1, d / 2, d / 2 + 1, std::uint64_t{1}}) {
      if (high >= d) continue;
      for (const std::uint64_t low : {std::uint64_t{0}, ~std::uint64_t{0}, d}) {
        const Unsigned128 n = (static_cast<Unsigned128>(high) << 64) | low;
        EXPECT_EQ(berth::divide_wide({high, low}, d), static_cast<std::uint64_t>(n / d));
      }
    }
  }
}

TEST(Wide, BitLengthsAndBlockExponents) {
  EXPECT_EQ(berth::bit_length(0), 0);
  EXPECT_EQ(berth::bit_length(1), 1);
  EXPECT_EQ(berth::bit_length(-256), 9);
  EXPECT_EQ(berth::bit_length(INT64_MIN), 64);
  const std::int64_t block[3] = {5, -100, 0};
  EXPECT_EQ(berth::block_shift(block, 3, 30), 23);
  EXPECT_EQ(berth::scale_by_power(-100, 23), -100ll * (1 << 23));
  EXPECT_EQ(berth::scale_by_power(7, -1), 4);
  EXPECT_EQ(berth::scale_by_power(INT64_MAX, -70), 0);
}

}  // namespace
}  // namespace berth_test
