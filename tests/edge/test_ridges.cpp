// The ridge search on two lanes against one cell at a time.
#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <random>
#include <vector>

#include "edge/ridges.hpp"

namespace berth {
namespace {

constexpr int kWords = 200;

// Three rows of random gradients, so coarse that neighbours are often equal.
std::unique_ptr<GradientRows> random_rows(unsigned seed) {
  auto rows = std::make_unique<GradientRows>();
  std::mt19937 random(seed);
  const int step = seed % 2 == 0 ? 1 : 3000;
  std::uniform_int_distribution<int> component(-12240 / step, 12240 / step);
  const auto lanes = [](int a, int b) {
    return static_cast<Pair>(a & 0xffff) | static_cast<Pair>(b & 0xffff) << 16;
  };
  for (auto& row : rows->gradients) {
    for (int k = 0; k < kWords; ++k) {
      const int x[2] = {step * component(random), step * component(random)};
      const int y[2] = {step * component(random), step * component(random)};
      row[k].gradient[0] = lanes(x[0], x[1]);
      row[k].gradient[1] = lanes(y[0], y[1]);
      row[k].magnitude = lanes(std::abs(x[0]) + std::abs(y[0]), std::abs(x[1]) + std::abs(y[1]));
    }
  }
  for (int k = 0; k < kWords; ++k) rows->strong_words[0][k] = static_cast<std::uint16_t>(k);
  rows->strong_count[0] = kWords;
  return rows;
}

bool is_ridge(const GradientRows& rows, int y, int k, int lane) {
  const GradientLane here = rows.row(y)[k].lane(lane);
  const int m = here.magnitude();
  const bool in_x = m > here.magnitude(-1) && m >= here.magnitude(1);
  const bool in_y = m > rows.row(y - 1)[k].lane(lane).magnitude() &&
                    m >= rows.row(y + 1)[k].lane(lane).magnitude();
  const int ax = std::abs(here.gx()), ay = std::abs(here.gy());
  const bool diagonal = std::abs(ax - ay) < m / 4;
  return (in_x && (ax >= ay || diagonal)) || (in_y && (ax < ay || diagonal));
}

TEST(Ridges, EqualOneCellAtATimeAlsoWhereNeighboursAreEqual) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    const auto rows = random_rows(seed);
    const int y = 4;
    for (const int threshold : {1, 9000, 24480}) {
      const auto ridges = std::make_unique<Ridges>();
      find_ridges(*rows, y, kWords, threshold, *ridges);
      for (int lane = 0; lane < 2; ++lane) {
        std::vector<int> expected;
        for (int k = kGridBorder; k < kWords - kGridBorder; ++k) {
          const bool is_strong = rows->row(y)[k].lane(lane).magnitude() >= threshold;
          if (is_strong && is_ridge(*rows, y, k, lane)) expected.push_back(k);
        }
        const std::vector<int> found(ridges->words[lane],
                                     ridges->words[lane] + ridges->count[lane]);
        ASSERT_EQ(found, expected) << "seed " << seed << " lane " << lane;
      }
    }
  }
}

}  // namespace
}  // namespace berth
