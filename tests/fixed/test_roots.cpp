// Roots and reciprocals: exact floors, nearest values, stated errors.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fixed/roots.hpp"
#include "reference.hpp"

namespace berth_test {
namespace {

__extension__ using Unsigned128 = unsigned __int128;

void expect_floor_root(std::uint64_t value) {
  const Unsigned128 root = berth::isqrt(value);
  EXPECT_LE(root * root, value);
  EXPECT_GT((root + 1) * (root + 1), value);
}

TEST(Roots, FloorAtEverySquareBoundary) {
  for (std::uint64_t root = 1; root < 200000; ++root) {
    EXPECT_EQ(berth::isqrt(root * root), root);
    EXPECT_EQ(berth::isqrt(root * root - 1), root - 1);
  }
  for (std::uint64_t root = 0xffff0000u; root <= 0xffffffffu; ++root) {
    EXPECT_EQ(berth::isqrt(root * root), root);
    EXPECT_EQ(berth::isqrt(root * root - 1), root - 1);
  }
  expect_floor_root(0);
  expect_floor_root(UINT64_MAX);
}

TEST(Roots, FloorOfEveryMagnitude) {
  Random random;
  for (int i = 0; i < 500000; ++i) expect_floor_root(random.bits() >> (i & 63));
}

TEST(Roots, NearestAndFormats) {
  EXPECT_EQ(berth::isqrt_nearest(6), 2u);  // 2.449
  EXPECT_EQ(berth::isqrt_nearest(7), 3u);  // 2.646
  EXPECT_EQ(berth::isqrt_nearest(UINT64_MAX), UINT32_MAX);
  Random random;
  for (int i = 0; i < 100000; ++i) {
    const auto a = berth::Mm::from_raw(random.any32() & INT32_MAX);
    EXPECT_LE(std::abs(real(berth::sqrt<24>(a)) - std::sqrt(real(a))) * 0x1p24, 0.5 + 1e-4);
  }
}

TEST(Roots, HypotOfTheLargestArguments) {
  EXPECT_EQ(berth::hypot(3, -4), 5u);
  EXPECT_EQ(berth::hypot(INT32_MIN, INT32_MIN), 3037000500u);
  Random random;
  for (int i = 0; i < 100000; ++i) {
    const std::int32_t x = random.any32(), y = random.any32();
    EXPECT_NEAR(berth::hypot(x, y), std::hypot(double{1} * x, double{1} * y), 0.5 + 1e-6);
  }
}

TEST(Roots, ReciprocalIsNearestMantissa) {
  Random random;
  double worst = 0;
  for (int i = 0; i < 500000; ++i) {
    const auto value = static_cast<std::uint32_t>((random.bits() >> 32) >> (i & 31)) | 1u;
    const berth::Reciprocal r = berth::reciprocal(value);
    EXPECT_GE(r.mantissa, 1 << 30);
    worst = std::max(worst, std::abs(std::ldexp(r.mantissa, r.shift - 62) * value - 1));
  }
  EXPECT_LE(worst, 0x1p-31 * 1.001);
  EXPECT_EQ(berth::multiply_reciprocal(-300, berth::reciprocal(400), 20), -786432);
}

TEST(Roots, SixteenMoreBits) {
  Random random;
  for (int i = 0; i < 500000; ++i) {
    const auto value = static_cast<std::uint32_t>(random.bits() >> (32 + (i & 31)));
    if (value == 0) continue;
    const long double root = std::sqrt(static_cast<long double>(value)) * 0x1p16L;
    EXPECT_LE(std::abs(berth::root_q16(value) - root), 2 + root * 0x1p-31L) << value;
  }
  EXPECT_EQ(berth::root_q16(1), 1u << 16);
  EXPECT_EQ(berth::root_q16(UINT32_MAX), UINT32_MAX);
}

TEST(Quotients, OfManyByOne) {
  Random random;
  for (int i = 0; i < 200000; ++i) {
    const auto divisor = static_cast<std::int64_t>(random.bits() >> (1 + i % 62)) | 1;
    const berth::QuickDivisor by(divisor);
    for (int k = 0; k < 4; ++k) {
      const auto x =
          static_cast<std::int64_t>(random.bits()) >> (2 + static_cast<int>(random.bits() & 31));
      const long double exact = static_cast<long double>(x) / static_cast<long double>(divisor);
      const long double clamped = std::clamp<long double>(exact, INT32_MIN, INT32_MAX);
      EXPECT_LE(std::abs(by.quotient(x) - clamped),
                0.51L + 2.0L / divisor + std::abs(clamped) * 0x1p-30L)
          << x << " / " << divisor;
    }
  }
}

TEST(Quotients, Short) {
  Random random;
  for (int i = 0; i < 500000; ++i) {
    const auto a = static_cast<std::int32_t>(random.bits() >> 32) >> (i & 31);
    const auto b = static_cast<std::int32_t>(random.bits() >> (33 + i % 31)) | 1;
    const auto fraction = static_cast<int>(random.bits() & 31);
    const long double exact = std::ldexp(static_cast<long double>(a), fraction) / b;
    const long double clamped = std::clamp<long double>(exact, INT32_MIN, INT32_MAX);
    EXPECT_LE(std::abs(berth::short_quotient(a, b, fraction) - clamped),
              0.51L + std::abs(clamped) * 0x1p-13L)
        << a << " / " << b << ", " << fraction;
  }
}

}  // namespace
}  // namespace berth_test
