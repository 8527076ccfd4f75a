// The measures of bench_edges on chains whose width, turning and distance are known.
#include <gtest/gtest.h>

#include <cmath>

#include "bench/edges/detectors.hpp"
#include "bench/edges/follow.hpp"
#include "bench/edges/truth.hpp"
#include "edge/edge_scene.hpp"
#include "host_sim/io/camera_file.hpp"
#include "host_sim/render/sample_scene.hpp"

namespace berth::bench {
namespace {

Detection detection_of(const std::vector<cv::Point>& pixels) {
  Detection d;
  d.grid = {200, 200};
  PixelChain chain;
  chain.pixels = pixels;
  for (const cv::Point& p : pixels) chain.places_px.push_back(centre_of(p, 1));
  d.chains.push_back(chain);
  return d;
}

std::vector<cv::Point> line(int count, int dx, int dy) {
  std::vector<cv::Point> pixels;
  for (int i = 0; i < count; ++i) pixels.emplace_back(20 + i * dx, 30 + i * dy);
  return pixels;
}

TrueContour circle(double x, double y, double radius) {
  TrueContour contour;
  const int count = static_cast<int>(2 * CV_PI * radius / 0.25);
  for (int k = 0; k < count; ++k) {
    const double t = 2 * CV_PI * k / count;
    contour.points_px.emplace_back(x + radius * std::cos(t), y + radius * std::sin(t));
    contour.is_visible.push_back(1);
  }
  return contour;
}

// In each octant the pixel nearest to the circle across it, in order.
std::vector<cv::Point> pixels_around(cv::Point2d centre, double radius) {
  std::vector<cv::Point> pixels;
  for (double t = 0; t < 2 * CV_PI; t += 0.001) {
    double x = centre.x + radius * std::cos(t), y = centre.y + radius * std::sin(t);
    const double dx = x - centre.x, dy = y - centre.y;
    if (std::abs(dx) > std::abs(dy)) {
      y = std::round(y);
      x = centre.x + std::copysign(std::sqrt(radius * radius - std::pow(y - centre.y, 2)), dx);
    } else {
      x = std::round(x);
      y = centre.y + std::copysign(std::sqrt(radius * radius - std::pow(x - centre.x, 2)), dy);
    }
    const cv::Point p(static_cast<int>(std::lround(x)), static_cast<int>(std::lround(y)));
    if (pixels.empty() || pixels.back() != p) pixels.push_back(p);
  }
  if (pixels.back() == pixels.front()) pixels.pop_back();
  return pixels;
}

TEST(BlockShare, OnlyFullBlocksOfFourCount) {
  EXPECT_EQ(block_share(detection_of(line(50, 1, 0))).value(), 0);
  EXPECT_EQ(block_share(detection_of(line(50, 1, 1))).value(), 0);
  std::vector<cv::Point> staircase;  // three of each four are edge pixels
  for (int i = 0; i < 40; ++i) staircase.emplace_back(20 + (i + 1) / 2, 20 + i / 2);
  EXPECT_EQ(block_share(detection_of(staircase)).value(), 0);
  auto thick = line(50, 1, 0);  // 10 of 60 pixels are doubled, and so are their partners
  for (int i = 0; i < 10; ++i) thick.push_back(thick[static_cast<size_t>(i)] + cv::Point(0, 1));
  EXPECT_DOUBLE_EQ(block_share(detection_of(thick)).value(), 20.0 / 60.0);
}

TEST(BlockShare, APixelOfTwoChainsCountsOnce) {
  Detection d = detection_of(line(50, 1, 0));
  d.chains.push_back(d.chains[0]);
  EXPECT_EQ(block_share(d).weight, 50);
}

TEST(Turning, StraightChainsDoNotTurn) {
  EXPECT_EQ(turning_deg(line(60, 1, 0)).value(), 0);
  EXPECT_EQ(turning_deg(line(60, -1, 1)).value(), 0);
  EXPECT_EQ(turning_deg(line(14, 1, 0)).weight, 0);  // below three baselines
}

TEST(Turning, OneRightAngleTurnsByNinetyDegreesInAll) {
  auto pixels = line(30, 1, 0);
  for (int i = 1; i < 30; ++i) pixels.push_back(pixels[29] + cv::Point(0, i));
  const Mean turning = turning_deg(pixels);
  EXPECT_NEAR(turning.sum, 90, 1e-9);
  EXPECT_EQ(turning.weight, 59 - kBaseline - 1);
}

TEST(Turning, AZigZagTurnsAsFarAsItsChordsSwing) {
  std::vector<cv::Point> pixels;
  for (int i = 0; i < 60; ++i) pixels.emplace_back(20 + i, 30 + i % 2);
  EXPECT_NEAR(turning_deg(pixels).value(), 2 * std::atan(1.0 / kBaseline) * 180 / CV_PI, 1e-9);
}

TEST(Compare, PlacesOnACircleHaveTheDistanceTheyWereGiven) {
  const std::vector<TrueContour> contours = {circle(100.3, 99.6, 60)};
  Detection d;
  d.grid = {200, 200};
  PixelChain chain;
  for (double t = 0; t < CV_PI; t += 1 / 60.0) {  // half of it, 0.7 px outside
    chain.places_px.emplace_back(100.3 + 60.7 * std::cos(t), 99.6 + 60.7 * std::sin(t));
    chain.pixels.emplace_back(chain.places_px.back());
  }
  d.chains.push_back(chain);
  const TruthTally tally = compare(d, contours);
  EXPECT_NEAR(tally.found.value(), 0.5, 0.01);
  EXPECT_NEAR(tally.places.mean.value(), 0.7, 1e-3);
  EXPECT_NEAR(tally.places.quantile(0.95), 0.7, 0.011);
  EXPECT_EQ(tally.pieces.value(), 1);
}

TEST(Compare, PixelsOfACircleAreAQuarterPixelOff) {
  const std::vector<TrueContour> contours = {circle(100.3, 99.6, 60)};
  const Detection d = detection_of(pixels_around({100.3, 99.6}, 60));
  const TruthTally tally = compare(d, contours);
  EXPECT_EQ(tally.found.value(), 1);
  // 0.25 across the axis, times the mean of max(|cos|, |sin|) = 0.90.
  EXPECT_NEAR(tally.pixels.mean.value(), 0.225, 0.02);
  EXPECT_GE(tally.turning.value(), 57.3 / 60);
}

TEST(Compare, OutlinesRoundedToPixelsAreTheBestThatPixelsCanBe) {
  const std::vector<TrueContour> contours = {circle(100.3, 99.6, 60)};
  const TruthTally tally = compare(round_outlines(contours, {200, 200}), contours);
  EXPECT_EQ(tally.found.value(), 1);
  EXPECT_EQ(tally.pieces.value(), 1);
  EXPECT_LT(tally.places.mean.value(), 1e-6);
  EXPECT_NEAR(tally.pixels.mean.value(), 0.225, 0.02);
  // A step along the axis is 1 to 1.41 px long, 1.12 in the mean over a circle.
  EXPECT_NEAR(tally.turning_of_places.value(), 57.3 / 60 * 1.12, 0.06);
  EXPECT_GT(tally.turning.value(), 3 * tally.turning_of_places.value());
}

TEST(Compare, PiecesAreChainsPerVisibleArc) {
  std::vector<TrueContour> contours = {circle(100, 100, 60)};
  auto& seen = contours[0].is_visible;
  for (size_t k = 0; k < seen.size() / 4; ++k) seen[k + 100] = 0;
  EXPECT_EQ(contours[0].arcs(), 1);
  for (size_t k = 0; k < 50; ++k) seen[seen.size() / 2 + 200 + k] = 0;
  EXPECT_EQ(contours[0].arcs(), 2);
  Detection d = detection_of(pixels_around({100, 100}, 60));
  EXPECT_EQ(compare(d, contours).pieces.value(), 0.5);  // one chain over both arcs
  PixelChain second;
  const auto split = d.chains[0].pixels.begin() + 300;
  second.pixels.assign(split, d.chains[0].pixels.end());
  second.places_px.assign(d.chains[0].places_px.begin() + 300, d.chains[0].places_px.end());
  d.chains[0].pixels.resize(300);
  d.chains[0].places_px.resize(300);
  d.chains.push_back(second);
  EXPECT_EQ(compare(d, contours).pieces.value(), 1);
}

TEST(Compare, FarPixelsDoNotCount) {
  const TruthTally tally =
      compare(detection_of(pixels_around({100, 100}, 63)), {circle(100, 100, 60)});
  EXPECT_EQ(tally.found.value(), 0);
  EXPECT_EQ(tally.places.mean.weight, 0);
}

TEST(TrueContours, HiddenPartsAreLeftOut) {
  const auto camera = host::default_camera();
  const auto target = host::default_target();
  host::SceneOptions options;
  options.clean = true;
  options.distance_mm = 400;
  options.tilt_deg = 0;
  auto contours = true_contours(sample_scene(options, 0, camera, target), camera, target);
  ASSERT_EQ(contours.size(), 8u);  // ring outside and inside, line, five dots
  const auto share = [](const TrueContour& c) {
    Mean mean;
    for (const char v : c.is_visible) mean.add(v);
    return mean.value();
  };
  for (const auto& c : contours) EXPECT_EQ(share(c), 1);
  options.tilt_deg = 45;  // the collar covers a part of the ring
  contours = true_contours(sample_scene(options, 0, camera, target), camera, target);
  EXPECT_LT(share(contours[0]), 0.95);
  EXPECT_EQ(contours[0].arcs(), 1);
}

TEST(Follow, EveryPixelOnceFromEndToEnd) {
  cv::Mat edges = cv::Mat::zeros(100, 100, CV_8U);
  for (const cv::Point& p : line(40, 1, 1)) edges.at<uchar>(p) = 255;
  double steps = 0;
  const auto chains = follow_contours(edges, 6, steps);
  ASSERT_EQ(chains.size(), 1u);
  EXPECT_EQ(chains[0].size(), 40u);
  EXPECT_EQ(steps, 41);  // each pixel, and the start once more for the way back
}

TEST(Detectors, OursIsCloserToADiscsRimThanItsPixels) {
  const cv::Mat image = disc_image(100, 100, 60, 190, 60, 200);
  const TruthTally tally = compare(make_ours(1).detect(image), {circle(100, 100, 60)});
  EXPECT_GT(tally.found.value(), 0.99);
  EXPECT_LT(tally.places.mean.value(), 0.6 * tally.pixels.mean.value());
}

}  // namespace
}  // namespace berth::bench
