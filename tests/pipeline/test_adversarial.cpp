// Images without a target that are made to confuse: never valid, always a reason, always an end.
#include <gtest/gtest.h>

#include <random>
#include <string>

#include "chain_tools.hpp"

namespace berth::test {
namespace {

void expect_refusal(const host::Image8& image, const std::string& what) {
  const FrameResult result = process(image);
  EXPECT_FALSE(result.valid) << what;
  EXPECT_FALSE(result.identified) << what;
  EXPECT_NE(result.reason, Reason::kNone) << what;
  EXPECT_NE(result.reason, Reason::kBadFrame) << what;
}

TEST(Adversarial, PureNoise) {
  for (const double sigma : {0.5, 3.0, 20.0, 80.0}) {
    std::mt19937 random(static_cast<unsigned>(sigma * 10));
    std::normal_distribution<double> noise(110, sigma);
    expect_refusal(painted([&](int, int) { return noise(random); }),
                   "noise of " + std::to_string(sigma));
  }
  std::mt19937 random(5);
  expect_refusal(painted([&](int, int) { return static_cast<double>(random() % 256); }), "uniform");
}

TEST(Adversarial, NoiseAtAllScales) {
  for (const int cell : {2, 4, 8, 16, 32}) {
    std::mt19937 random(static_cast<unsigned>(cell));
    std::vector<double> cells(1024 * 1024);
    for (double& c : cells) c = static_cast<double>(random() % 256);
    expect_refusal(painted([&](int x, int y) {
                     return cells[static_cast<std::size_t>((y / cell) * 1024 + x / cell)];
                   }),
                   "cells of " + std::to_string(cell));
  }
}

TEST(Adversarial, Checkerboards) {
  for (const int pitch : {1, 2, 3, 4, 5, 8, 13, 32, 100}) {
    expect_refusal(painted([&](int x, int y) { return (x / pitch + y / pitch) % 2 ? 220 : 30; }),
                   "pitch " + std::to_string(pitch));
  }
}

TEST(Adversarial, Gratings) {
  for (const double period : {2.0, 3.0, 4.5, 7.0, 16.0, 60.0}) {
    for (const double angle : {0.0, 0.4, 1.5708}) {
      expect_refusal(painted([&](int x, int y) {
                       const double u = x * std::cos(angle) + y * std::sin(angle);
                       return 128 + 100 * std::sin(2 * M_PI * u / period);
                     }),
                     "period " + std::to_string(period));
    }
  }
}

TEST(Adversarial, ConcentricRings) {
  for (const double period : {4.0, 8.0, 15.0, 30.0, 60.0, 150.0}) {
    expect_refusal(painted([&](int x, int y) {
                     const double r = std::hypot(x - 500.3, y - 520.7);
                     return 128 + 100 * std::sin(2 * M_PI * r / period);
                   }),
                   "period " + std::to_string(period));
  }
}

TEST(Adversarial, RingsEverywhere) {
  for (const int pitch : {24, 40, 64, 128, 256}) {
    expect_refusal(painted([&](int x, int y) {
                     const double r = std::hypot(x % pitch - pitch / 2, y % pitch - pitch / 2);
                     return r > 0.3 * pitch && r < 0.375 * pitch ? 200 : 30;
                   }),
                   "pitch " + std::to_string(pitch));
  }
}

TEST(Adversarial, DotsEverywhere) {
  for (const int pitch : {12, 20, 45}) {
    expect_refusal(painted([&](int x, int y) {
                     const double r = std::hypot(x % pitch - pitch / 2, y % pitch - pitch / 2);
                     return r < 0.3 * pitch ? 200 : 30;
                   }),
                   "pitch " + std::to_string(pitch));
  }
}

TEST(Adversarial, PlainAndSaturated) {
  for (const int level : {0, 1, 127, 254, 255}) {
    expect_refusal(painted([&](int, int) { return level; }), std::to_string(level));
  }
  expect_refusal(painted([](int x, int) { return x < 512 ? 255 : 40; }), "half saturated");
  expect_refusal(painted([](int x, int y) { return (x * y) % 7 ? 255 : 0; }), "nearly white");
  expect_refusal(painted([](int x, int y) { return (x + y) / 8; }), "ramp");
}

TEST(Adversarial, WrongSizeIsABadFrame) {
  host::Image8 image = painted([](int, int) { return 100; });
  image.height = 1023;
  const FrameResult result = process(image);
  EXPECT_EQ(result.reason, Reason::kBadFrame);
  EXPECT_FALSE(result.valid);
}

}  // namespace
}  // namespace berth::test
