// Area coverage of polygons: against areas, against sampling, and where the grid cuts them.
#include <gtest/gtest.h>

#include <cmath>

#include "host_sim/render/coverage.hpp"
#include "host_sim/render/random.hpp"

namespace berth::host {
namespace {

double shoelace(const Polygon& p) {
  double area = 0;
  for (size_t i = 0, j = p.size() - 1; i < p.size(); j = i++) {
    area += p[j].x() * p[i].y() - p[i].x() * p[j].y();
  }
  return std::abs(0.5 * area);
}

bool is_inside(const Polygon& p, double x, double y) {
  bool inside = false;
  for (size_t i = 0, j = p.size() - 1; i < p.size(); j = i++) {
    if ((p[i].y() > y) != (p[j].y() > y) &&
        x < p[i].x() + (y - p[i].y()) * (p[j].x() - p[i].x()) / (p[j].y() - p[i].y())) {
      inside = !inside;
    }
  }
  return inside;
}

Polygon random_star(Random& random, double cx, double cy, double reach) {
  Polygon star;
  for (int i = 0; i < 9; ++i) {
    const double angle = 2.0 * 3.14159265 * (i + random.uniform(0.0, 0.8)) / 9;
    const double radius = reach * random.uniform(0.2, 1.0);
    star.emplace_back(cx + radius * std::cos(angle), cy + radius * std::sin(angle));
  }
  return star;
}

CoverageBuffer covered(const Polygon& polygon, const Grid& grid) {
  CoverageBuffer buffer;
  buffer.reset(grid);
  buffer.add_polygon(polygon);
  buffer.resolve();
  return buffer;
}

double sum_of(const CoverageBuffer& buffer) {
  double sum = 0;
  for (int y = 0; y < buffer.grid().height; ++y) {
    for (int x = 0; x < buffer.grid().width; ++x) sum += buffer.row(y)[x];
  }
  return sum;
}

TEST(Coverage, SumIsThePolygonsArea) {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    Polygon star = random_star(random, 20.0 + random.uniform(), 20.0 + random.uniform(), 18.0);
    if (i % 2 == 0) std::reverse(star.begin(), star.end());
    for (const int cells : {1, 4}) {
      const Grid grid{0, 0, 40 * cells, 40 * cells, cells};
      EXPECT_NEAR(sum_of(covered(star, grid)) / (cells * cells), shoelace(star), 1e-3);
    }
  }
}

TEST(Coverage, CellsMatchSampling) {
  constexpr int kSamples = 40;
  Random random(4);
  for (int i = 0; i < 5; ++i) {
    // Larger than the grid on every side: edges are cut by all four borders.
    const Polygon star = random_star(random, 6.0, 6.0, 14.0);
    const CoverageBuffer buffer = covered(star, {0, 0, 12, 12, 1});
    for (int y = 0; y < 12; ++y) {
      for (int x = 0; x < 12; ++x) {
        int hits = 0;
        for (int s = 0; s < kSamples * kSamples; ++s) {
          const double u = x - 0.5 + (s % kSamples + 0.5) / kSamples;
          const double v = y - 0.5 + (s / kSamples + 0.5) / kSamples;
          hits += is_inside(star, u, v) ? 1 : 0;
        }
        EXPECT_NEAR(buffer.row(y)[x], hits / double(kSamples * kSamples), 0.02);
      }
    }
  }
}

TEST(Coverage, EdgesOnCellBordersAreExact) {
  const Polygon square{{1.5, 1.5}, {4.5, 1.5}, {4.5, 3.5}, {1.5, 3.5}};
  const CoverageBuffer buffer = covered(square, {0, 0, 8, 6, 1});
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 8; ++x) {
      const bool inside = x >= 2 && x <= 4 && y >= 2 && y <= 3;
      EXPECT_EQ(buffer.row(y)[x], inside ? 1.0f : 0.0f);
    }
  }
}

TEST(Coverage, HoleIsTakenAway) {
  CoverageBuffer buffer;
  buffer.reset({0, 0, 10, 10, 1});
  buffer.add_polygon({{0.5, 0.5}, {8.5, 0.5}, {8.5, 8.5}, {0.5, 8.5}});
  buffer.add_polygon({{2.5, 2.5}, {2.5, 5.0}, {5.0, 5.0}, {5.0, 2.5}}, -1.0f);
  buffer.resolve();
  EXPECT_NEAR(sum_of(buffer), 64.0 - 6.25, 1e-5);
  EXPECT_NEAR(buffer.row(5)[5], 0.75, 1e-6);
  EXPECT_EQ(buffer.row(4)[4], 0.0f);
}

TEST(Coverage, PolygonsBesideTheGridLeaveNoTrace) {
  for (const double x : {-100.0, 100.0}) {
    const CoverageBuffer buffer = covered({{x, -5}, {x + 20, -5}, {x + 20, 50}}, {0, 0, 16, 16, 1});
    EXPECT_NEAR(sum_of(buffer), 0.0, 1e-5);
  }
}

}  // namespace
}  // namespace berth::host
