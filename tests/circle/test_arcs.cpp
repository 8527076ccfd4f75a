// Arcs: stretches of chains that turn about something bright, against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "circle/ring_candidates.hpp"
#include "edge_scene.hpp"

namespace berth {
namespace {

cv::Mat ellipse_image(double major, double minor, double angle_deg, int inside, int outside) {
  cv::Mat image(400, 400, CV_8U, cv::Scalar(outside));
  // Sixteen times as fine: the rasterizer's coordinates have 4 fraction bits.
  const cv::Point center(200 * 16, 200 * 16);
  cv::ellipse(image, center, cv::Size(int(major * 16), int(minor * 16)), angle_deg, 0, 360,
              cv::Scalar(inside), cv::FILLED, cv::LINE_AA, 4);
  cv::GaussianBlur(image, image, {0, 0}, 0.8);
  return image;
}

std::vector<Arc> arcs_of(const EdgeScene& scene, int most = 16) {
  std::vector<Arc> arcs(static_cast<std::size_t>(most));
  arcs.resize(static_cast<std::size_t>(find_arcs(scene.map, scene.set, arcs, scene.work)));
  return arcs;
}

TEST(Arcs, DirectionIsTheAngleInSteps) {
  for (int degrees = 0; degrees < 360; ++degrees) {
    const double a = degrees * M_PI / 180;
    const int d =
        direction_of(int(std::lround(9000 * std::cos(a))), int(std::lround(9000 * std::sin(a))));
    // Borders of the steps are multiples of 11.25 degrees, their tangents are rounded to 1/256.
    const double middle = (d + 0.5) * 11.25;
    EXPECT_LT(std::abs(std::remainder(degrees - middle, 360.0)), 5.625 + 0.3) << degrees;
  }
}

class TiltedDisc : public testing::TestWithParam<std::tuple<int, int>> {};

TEST_P(TiltedDisc, TurnsOnceAtAnyTiltAndIsFitted) {
  const auto [tilt_deg, angle_deg] = GetParam();
  const double major = 120, minor = major * std::cos(tilt_deg * M_PI / 180);
  EdgeScene scene(ellipse_image(major, minor, angle_deg, 180, 50));
  const auto arcs = arcs_of(scene);
  ASSERT_FALSE(arcs.empty());
  // The chain is cut at its first pixel, where hysteresis may take a step from either end.
  EXPECT_NEAR(arcs[0].turn, kFullTurn, 2);
  RingCandidate ring;
  ASSERT_TRUE(fit_ring(scene.map, scene.set, arcs[0], 28, ring, scene.work));
  // OpenCV fills half a pixel beyond the outline, a quarter of a cell.
  EXPECT_NEAR(ring.axes.major.raw() / 65536.0, major / 2 + 0.25, 0.12);
  EXPECT_NEAR(ring.axes.minor.raw() / 65536.0, minor / 2 + 0.25, 0.12);
  EXPECT_NEAR(ring.ellipse.cx.raw() / 65536.0, (200 - 0.5) / 2, 0.1);
  EXPECT_NEAR(ring.ellipse.cy.raw() / 65536.0, (200 - 0.5) / 2, 0.1);
  EXPECT_TRUE(is_explained(scene.map, scene.set, arcs[0], ring));
}

INSTANTIATE_TEST_SUITE_P(TiltsAndTurns, TiltedDisc,
                         testing::Combine(testing::Values(0, 30, 50, 60),
                                          testing::Values(0, 20, 45, 77, 90, 130)));

TEST(Arcs, ADarkDiscHasNone) {
  EdgeScene scene(ellipse_image(120, 90, 30, 50, 180));
  ASSERT_GT(scene.set.count, 0);
  EXPECT_TRUE(arcs_of(scene).empty());
}

TEST(Arcs, StraightEdgesHaveNone) {
  cv::Mat image(400, 400, CV_8U, cv::Scalar(50));
  cv::line(image, {-50, 120}, {450, 330}, cv::Scalar(200), 60);
  cv::GaussianBlur(image, image, {0, 0}, 0.8);
  EdgeScene scene(image);
  ASSERT_GT(scene.set.count, 0);
  EXPECT_TRUE(arcs_of(scene).empty());
}

TEST(Arcs, ABiteCutsTheOutlineAndLeavesItsEllipse) {
  cv::Mat image = ellipse_image(130, 80, 25, 180, 50);
  cv::circle(image, {310, 250}, 45, cv::Scalar(50), cv::FILLED, cv::LINE_AA);
  cv::GaussianBlur(image, image, {0, 0}, 0.8);
  EdgeScene scene(image);
  const auto arcs = arcs_of(scene);
  ASSERT_FALSE(arcs.empty());
  EXPECT_LT(arcs[0].turn, kFullTurn - 3);  // the bite's own rim bends the other way
  RingCandidate ring;
  ASSERT_TRUE(fit_ring(scene.map, scene.set, arcs[0], 14, ring, scene.work));
  EXPECT_NEAR(ring.axes.major.raw() / 65536.0, 65, 0.5);
  EXPECT_NEAR(ring.axes.minor.raw() / 65536.0, 40, 0.5);
}

TEST(Arcs, AFullPoolKeepsThoseThatTurnFurthest) {
  cv::Mat image(400, 400, CV_8U, cv::Scalar(50));
  for (int i = 0; i < 9; ++i) {
    const cv::Point at(70 + 130 * (i % 3), 70 + 130 * (i / 3));
    cv::circle(image, at, 40, cv::Scalar(180), cv::FILLED, cv::LINE_AA);
    // Even ones lose a half.
    if (i % 2 == 0) cv::rectangle(image, at - cv::Point(60, 60), at + cv::Point(0, 60), 50, -1);
  }
  cv::GaussianBlur(image, image, {0, 0}, 0.8);
  EdgeScene scene(image);
  for (const Arc& arc : arcs_of(scene, 4)) EXPECT_NEAR(arc.turn, kFullTurn, 2);
}

}  // namespace
}  // namespace berth
