// The conic's normal equations against Eigen's factorisation in double.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>
#include <vector>

#include "circle/conic_system.hpp"

namespace berth {
namespace {

struct Point {
  std::int32_t x, y;  // 12 fraction bits
};

// Points of an arc of a circle about a centre off the origin, noisy.
std::vector<Point> arc(double turn_rad, double noise, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> error(0, noise);
  std::uniform_real_distribution<double> place(-0.2, 0.2);
  const double cx = place(random), cy = place(random), start = 10 * place(random);
  std::vector<Point> points;
  for (int k = 0; k < 60; ++k) {
    const double t = start + turn_rad * k / 60;
    points.push_back(
        {static_cast<std::int32_t>(std::lround(4096 * (cx + std::cos(t) + error(random)))),
         static_cast<std::int32_t>(std::lround(4096 * (cy + std::sin(t) + error(random))))});
  }
  return points;
}

struct Normal {
  Eigen::Matrix<double, 5, 5> matrix = Eigen::Matrix<double, 5, 5>::Zero();
  Eigen::Matrix<double, 5, 1> sums = Eigen::Matrix<double, 5, 1>::Zero();

  explicit Normal(const std::vector<Point>& points) {
    for (const Point& p : points) {
      const double x = p.x / 4096.0, y = p.y / 4096.0;
      Eigen::Matrix<double, 5, 1> v;
      v << x * x, x * y, y * y, x, y;
      matrix += v * v.transpose();
      sums += v;
    }
  }
};

double residual(const std::vector<Point>& points, const Eigen::Matrix<double, 5, 1>& k) {
  double sum = 0;
  for (const Point& p : points) {
    const double x = p.x / 4096.0, y = p.y / 4096.0;
    sum += std::pow(k[0] * x * x + k[1] * x * y + k[2] * y * y + k[3] * x + k[4] * y - 1, 2);
  }
  return std::sqrt(sum / static_cast<double>(points.size()));
}

bool solve(const std::vector<Point>& points, Eigen::Matrix<double, 5, 1>& k) {
  ConicSystem system;
  for (const Point& p : points) system.add(p.x, p.y);
  std::int32_t raw[kConicTerms];
  if (!system.solve(raw)) return false;
  for (int i = 0; i < 5; ++i) k[i] = raw[i] / 16777216.0;
  return true;
}

// Short arcs leave directions of k undetermined; what must agree is how well the conic fits.
TEST(ConicSystem, FitsAsWellAsInDoubleFromAThirdOfATurnOn) {
  for (const double turn : {2.16, 3.0, 4.2, 6.28}) {
    for (unsigned seed = 0; seed < 200; ++seed) {
      const auto points = arc(turn, 0.005, seed);
      const Normal normal(points);
      const Eigen::Matrix<double, 5, 1> expected = normal.matrix.ldlt().solve(normal.sums);
      Eigen::Matrix<double, 5, 1> found;
      ASSERT_TRUE(solve(points, found)) << turn << " " << seed;
      EXPECT_LT(residual(points, found), 1.002 * residual(points, expected) + 1e-4);
      if (turn > 4) {
        EXPECT_LT((found - expected).norm(), 2e-3) << turn << " " << seed;
      }
    }
  }
}

TEST(ConicSystem, PointsThatDetermineNoConicAreRefused) {
  Eigen::Matrix<double, 5, 1> k;
  EXPECT_FALSE(solve({}, k));
  EXPECT_FALSE(solve({{4096, 0}, {0, 4096}, {-4096, 0}, {0, -4096}}, k));  // four points
  std::vector<Point> line, one;
  for (int i = 0; i < 60; ++i) line.push_back({100 * i - 3000, 1000 + 50 * i});
  EXPECT_FALSE(solve(line, k));
  for (int i = 0; i < 60; ++i) one.push_back({8191, -8191});
  EXPECT_FALSE(solve(one, k));
  EXPECT_FALSE(solve(std::vector<Point>(60, Point{0, 0}), k));
}

TEST(ConicSystem, ManyPointsAtTheEndOfTheRangeDoNotOverflow) {
  std::vector<Point> points;
  for (int i = 0; i < 65535; ++i) {
    const double t = i * 0.001;
    points.push_back({static_cast<std::int32_t>(8191 * std::cos(t)),
                      static_cast<std::int32_t>(8191 * std::sin(t))});
  }
  Eigen::Matrix<double, 5, 1> k;
  ASSERT_TRUE(solve(points, k));
  EXPECT_NEAR(k[0], 0.25, 1e-3);
  EXPECT_NEAR(k[2], 0.25, 1e-3);
  EXPECT_NEAR(k[1], 0, 1e-3);
}

}  // namespace
}  // namespace berth
