#include <gtest/gtest.h>

#include <cmath>

#include "tmtc/space_packet.hpp"

namespace berth {
namespace {

TEST(CucTime, of_known_instants) {
  EXPECT_EQ(cuc_from_us(0), (CucTime{0, 0}));
  EXPECT_EQ(cuc_from_us(125000), (CucTime{0, 1u << 21}));  // an eighth of a second
  EXPECT_EQ(cuc_from_us(1000000), (CucTime{1, 0}));
  EXPECT_EQ(cuc_from_us(999999), (CucTime{0, 16777199}));
  EXPECT_EQ(cuc_from_us(4294967295999999ull), (CucTime{0xffffffff, 16777199}));
}

TEST(CucTime, gives_back_the_microsecond) {
  for (std::uint64_t time_us = 0; time_us < 4000000; time_us += 997) {
    const CucTime cuc = cuc_from_us(time_us);
    const double back_us = (cuc.seconds + std::ldexp(cuc.fraction, -24)) * 1e6;
    EXPECT_NEAR(back_us, static_cast<double>(time_us), 0.06);
    EXPECT_LE(back_us, static_cast<double>(time_us) + 1e-6);
  }
}

}  // namespace
}  // namespace berth
