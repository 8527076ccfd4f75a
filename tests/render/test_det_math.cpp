// The deterministic functions against the C library.
#include <gtest/gtest.h>

#include <cmath>

#include "host_sim/render/det_math.hpp"

namespace berth::host {
namespace {

TEST(DetMath, SineAndCosine) {
  for (int i = -200000; i <= 200000; ++i) {
    const double x = i * 0.00037;
    const SinCos a = det_sincos(x);
    ASSERT_NEAR(a.sin, std::sin(x), 3e-16) << x;
    ASSERT_NEAR(a.cos, std::cos(x), 3e-16) << x;
  }
  EXPECT_EQ(det_sincos(0.0).sin, 0.0);
  EXPECT_EQ(det_sincos(0.0).cos, 1.0);
}

TEST(DetMath, Exponential) {
  for (int i = -140000; i <= 140000; ++i) {
    const double x = i * 0.005;
    ASSERT_NEAR(det_exp(x) / std::exp(x), 1.0, 1e-15) << x;
  }
  EXPECT_EQ(det_exp(0.0), 1.0);
  EXPECT_EQ(det_exp(-1e6), 0.0);
}

TEST(DetMath, Logarithm) {
  for (int i = 1; i <= 200000; ++i) {
    const double x = std::exp2((i - 100000) * 0.004);
    ASSERT_NEAR(det_log(x), std::log(x), 4e-16 * (1.0 + std::abs(std::log(x)))) << x;
  }
  EXPECT_EQ(det_log(1.0), 0.0);
}

TEST(DetMath, Power) {
  for (const double exponent : {0.45, 1.0, 2.2}) {
    for (int i = 1; i <= 1000; ++i) {
      const double x = i / 1000.0;
      ASSERT_NEAR(det_pow(x, exponent), std::pow(x, exponent), 2e-15) << x;
    }
  }
  EXPECT_EQ(det_pow(0.0, 2.2), 0.0);
  EXPECT_EQ(det_pow(0.0, 0.0), 1.0);
}

}  // namespace
}  // namespace berth::host
