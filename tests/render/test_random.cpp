// Laws of the random numbers and of the low-discrepancy sequence.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "host_sim/render/random.hpp"
#include "host_sim/render/sobol.hpp"

namespace berth::host {
namespace {

TEST(Random, UniformMomentsAndStreams) {
  Random random(1);
  double sum = 0, sum2 = 0;
  constexpr int kCount = 1000000;
  for (int i = 0; i < kCount; ++i) {
    const double u = random.uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    sum += u;
    sum2 += u * u;
  }
  EXPECT_NEAR(sum / kCount, 0.5, 0.0015);
  EXPECT_NEAR(sum2 / kCount, 1.0 / 3.0, 0.0015);
  std::set<uint64_t> firsts;
  for (uint64_t stream = 0; stream < 1000; ++stream) firsts.insert(Random(7, stream).bits());
  EXPECT_EQ(firsts.size(), 1000u);
}

// Kolmogorov's distance to the normal distribution, and the tails that the ziggurat treats apart.
TEST(Random, GaussianIsGaussian) {
  constexpr int kCount = 1000000;
  Random random(2);
  std::vector<double> values(kCount);
  for (double& v : values) v = random.gaussian();
  std::sort(values.begin(), values.end());
  double distance = 0;
  for (int i = 0; i < kCount; ++i) {
    const double expected = 0.5 * std::erfc(-values[static_cast<size_t>(i)] / std::sqrt(2.0));
    distance = std::max(distance, std::abs((i + 0.5) / kCount - expected));
  }
  EXPECT_LT(distance * std::sqrt(static_cast<double>(kCount)), 1.63);  // 1 % level
  const auto beyond = [&](double limit) {
    return std::count_if(values.begin(), values.end(),
                         [limit](double v) { return std::abs(v) > limit; });
  };
  EXPECT_NEAR(static_cast<double>(beyond(3.0)), 2700.0, 4.0 * std::sqrt(2700.0));
  EXPECT_NEAR(static_cast<double>(beyond(4.0)), 63.3, 4.0 * std::sqrt(63.3));
}

// Each dimension alone: of the first 2^k points exactly one falls into each 2^k-th of (0, 1).
TEST(Sobol, EveryDimensionIsStratified) {
  constexpr int kCount = 1024;
  for (int d = 0; d < kSobolDimensions; ++d) {
    std::vector<int> hits(kCount, 0);
    for (uint32_t i = 0; i < kCount; ++i) {
      ++hits[static_cast<size_t>(scrambled_sobol(11, i, d) * kCount)];
    }
    EXPECT_EQ(std::count(hits.begin(), hits.end(), 1), kCount) << "dimension " << d;
  }
}

// Scatter of counts in the cells of a grid, over that of independent points (1).
double relative_scatter(int a, int b, int cells, uint32_t count) {
  std::vector<int> hits(static_cast<size_t>(cells) * static_cast<size_t>(cells), 0);
  for (uint32_t i = 0; i < count; ++i) {
    const int x = static_cast<int>(scrambled_sobol(5, i, a) * cells);
    const int y = static_cast<int>(scrambled_sobol(5, i, b) * cells);
    ++hits[static_cast<size_t>(y * cells + x)];
  }
  const double mean = static_cast<double>(count) / (cells * cells);
  double sum2 = 0;
  for (const int h : hits) sum2 += (h - mean) * (h - mean);
  return sum2 / (cells * cells) / mean;
}

TEST(Sobol, PairsAreMoreEvenThanRandom) {
  double worst = 0;
  for (int a = 0; a < kSobolDimensions; ++a) {
    for (int b = 0; b < a; ++b) worst = std::max(worst, relative_scatter(a, b, 8, 4096));
  }
  EXPECT_LT(worst, 0.75);
  EXPECT_LT(relative_scatter(0, 1, 16, 1000), 0.3);  // a prefix that is no power of two
  EXPECT_LT(relative_scatter(2, 3, 16, 1000), 0.3);
}

// Over many seeds each point is uniform: only then do means over a campaign have no bias.
TEST(Sobol, EachPointIsUniformOverSeeds) {
  constexpr int kSeeds = 20000;
  for (const uint32_t index : {0u, 1u, 1000u}) {
    double sum = 0, sum2 = 0;
    for (uint64_t seed = 0; seed < kSeeds; ++seed) {
      const double u = scrambled_sobol(seed, index, 3);
      sum += u;
      sum2 += u * u;
    }
    EXPECT_NEAR(sum / kSeeds, 0.5, 0.01);
    EXPECT_NEAR(sum2 / kSeeds, 1.0 / 3.0, 0.01);
  }
}

}  // namespace
}  // namespace berth::host
