// The packed operations' portable twins against one lane at a time.
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "image/packed.hpp"
#include "packed_sweep.hpp"

namespace berth {
namespace {

int lane(Pair pair, int index) { return static_cast<int>(pair >> (16 * index) & 0xffffu); }
int byte(std::uint32_t word, int index) { return static_cast<int>(word >> (8 * index) & 0xffu); }
int as_signed(int lane) { return lane < 32768 ? lane : lane - 65536; }

// Every value of a lane against a few of the other operand, with a neighbour that would carry.
template <typename F>
void for_each_pair(F f) {
  std::mt19937 generator(1);
  const auto random = [&] { return static_cast<std::uint32_t>(generator()); };
  for (std::uint32_t a = 0; a < 65536; ++a) {
    for (const std::uint32_t b : {0u, 1u, 0x7fffu, 0x8000u, 0xffffu, a, a + 1, random()}) {
      f(a << 16 | (random() & 0xffffu), (b & 0xffffu) << 16 | 0xffffu);
      f((random() & 0xffff0000u) | a, 0x80010000u | (b & 0xffffu));
    }
  }
}

TEST(Packed, LanesNeverCarryIntoEachOther) {
  for_each_pair([](Pair a, Pair b) {
    const Pair mean = portable::halve_sums(a, b), sum = portable::add_pairs(a, b),
               difference = portable::subtract_pairs(a, b), size = portable::absolute_pair(a);
    for (int i = 0; i < 2; ++i) {
      ASSERT_EQ(lane(mean, i), (lane(a, i) + lane(b, i)) / 2);
      ASSERT_EQ(lane(sum, i), (lane(a, i) + lane(b, i)) & 0xffff);
      ASSERT_EQ(lane(difference, i), (lane(a, i) - lane(b, i)) & 0xffff);
      ASSERT_EQ(lane(size, i), std::abs(as_signed(lane(a, i))));
    }
  });
}

TEST(Packed, ExcessIsZeroBelowAndTheDifferenceAbove) {
  for_each_pair([](Pair a, Pair b) {
    a &= 0x7fff7fffu;
    b &= 0x7fff7fffu;
    const Pair excess = portable::excess(a, b);
    for (int i = 0; i < 2; ++i) {
      ASSERT_EQ(lane(excess, i), std::max(lane(a, i) - lane(b, i), 0));
    }
  });
}

TEST(Packed, BytesStayApart) {
  for_each_pair([](Pair a, Pair b) {
    const std::uint32_t means = portable::halve_byte_sums(a, b);
    int sum = 0;
    for (int i = 0; i < 4; ++i) {
      ASSERT_EQ(byte(means, i), (byte(a, i) + byte(b, i)) / 2);
      sum += byte(a, i);
    }
    ASSERT_EQ(portable::sum_bytes(a), static_cast<std::uint32_t>(sum));
  });
}

TEST(Packed, ProductsKeepTheirSigns) {
  for_each_pair([](Pair a, Pair b) {
    const std::int64_t sum = 17 + std::int64_t{as_signed(lane(a, 0))} * as_signed(lane(b, 0)) +
                             std::int64_t{as_signed(lane(a, 1))} * as_signed(lane(b, 1));
    if (sum > INT32_MAX) return;
    ASSERT_EQ(portable::add_products(a, b, 17), sum);
  });
}

TEST(Packed, WhatTheCompilerOffersEqualsTheTwin) {
  for (const PackedSweep& sweep : kPackedSweeps) {
    std::uint32_t differences = 0;
    sweep.run(differences);
    EXPECT_EQ(differences, 0u) << sweep.name;
  }
}

}  // namespace
}  // namespace berth
