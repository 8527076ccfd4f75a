// Q<F>: rounding, formats and saturation against double; range violations are caught.
#include <gtest/gtest.h>

#include "fixed/q.hpp"
#include "reference.hpp"

namespace berth_test {
namespace {

using berth::Mm;
using berth::Q;
using berth::Unit;

TEST(Q, LiteralsAreRoundedToNearest) {
  EXPECT_EQ(berth::q<16>(0.6).raw(), 39322);
  EXPECT_EQ(berth::q<16>(-0.6).raw(), -39322);
  EXPECT_EQ(berth::q<30>(1.0).raw(), 1 << 30);
}

TEST(Q, ProductsAreWithinHalfAStepInTheCoarserFormat) {
  Random random;
  for (int i = 0; i < 200000; ++i) {
    const auto a = Unit::from_raw(random.any32() >> 1);
    const auto b = Mm::from_raw(random.any32());
    const double exact = real(a) * real(b);  // 53 bits hold it to 2^-9 of a step
    EXPECT_LE(std::abs(real(a * b) - exact) * 0x1p18, 0.5 + 0x1p-8);
    EXPECT_EQ(a * b, b * a);
    if (std::abs(exact) < 127) {
      EXPECT_LE(std::abs(real(berth::mul<24>(a, b)) - exact) * 0x1p24, 0.51);
    }
  }
}

TEST(Q, QuotientsAreNearest) {
  Random random;
  for (int i = 0; i < 200000; ++i) {
    const auto a = Mm::from_raw(random.any32());
    const auto b = Mm::from_raw(random.any32() | 1);
    const double exact = real(a) / real(b);
    if (std::abs(exact) >= 1.99) continue;
    EXPECT_LE(std::abs(real(berth::div<30>(a, b)) - exact) * 0x1p30, 0.5 + 1e-6);
  }
}

TEST(Q, ConversionsRoundHalvesUpAndSaturateByName) {
  EXPECT_EQ(Q<2>::from_raw(2).round(), 1);    // 0.5
  EXPECT_EQ(Q<2>::from_raw(-2).round(), 0);   // -0.5
  EXPECT_EQ(Q<2>::from_raw(-3).floor(), -1);  // -0.75
  EXPECT_EQ(Q<2>::from_raw(2).to<0>().raw(), 1);
  EXPECT_EQ(Mm(8000).to_saturated<30>(), Unit::max());
  EXPECT_EQ(Mm(-8000).to_saturated<30>(), Unit::lowest());
  EXPECT_EQ(berth::saturate32(std::int64_t{INT32_MAX} + 1), INT32_MAX);
  EXPECT_EQ(berth::saturate32(std::int64_t{INT32_MIN} - 1), INT32_MIN);
  EXPECT_EQ(berth::saturate32(INT32_MIN), INT32_MIN);
}

#if BERTH_RANGE_CHECK
TEST(QRangeDeathTest, OverflowStopsTheRangeCheckingBuild) {
  EXPECT_DEATH(Unit(1) + Unit(1), "");
  EXPECT_DEATH(Mm(4096) * Mm(4096), "");
  EXPECT_DEATH(Mm(2).to<30>(), "");
  EXPECT_DEATH((berth::div<18>(Mm(1), Mm(0))), "");
}
#endif

}  // namespace
}  // namespace berth_test
