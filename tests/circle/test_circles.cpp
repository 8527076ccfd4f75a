// Isophote votes and ring fits on drawings.
#include <gtest/gtest.h>

#include "circle/ring_candidates.hpp"
#include "edge_scene.hpp"

namespace berth {
namespace {

std::vector<CircleCandidate> candidates_of(EdgeScene& scene) {
  auto votes = std::make_unique<VoteSpace>();
  cast_votes(scene.map, scene.set, *votes, scene.work);
  std::vector<CircleCandidate> list(32);
  list.resize(static_cast<std::size_t>(find_candidates(*votes, list, scene.work)));
  return list;
}

class DiscTest : public testing::TestWithParam<std::tuple<double, int>> {};

TEST_P(DiscTest, VotesMeetAtTheCentreForBothPolarities) {
  const auto [radius, polarity] = GetParam();
  const int inside = polarity ? 180 : 60, outside = polarity ? 60 : 180;
  EdgeScene scene(disc_image(203.4, 196.2, radius, inside, outside));
  const auto list = candidates_of(scene);
  ASSERT_FALSE(list.empty());
  const double r = radius / 2;  // cells
  EXPECT_NEAR(list[0].x, (203.4 - 0.5) / 2, 0.25 * r + 1);
  EXPECT_NEAR(list[0].y, (196.2 - 0.5) / 2, 0.25 * r + 1);
  EXPECT_LE(list[0].radius_min, 1.2 * r);
  EXPECT_GE(2.4 * list[0].radius_min, r);
}

TEST_P(DiscTest, ChainPixelsKnowRadiusAndPolarity) {
  const auto [radius, polarity] = GetParam();
  const int inside = polarity ? 180 : 60, outside = polarity ? 60 : 180;
  EdgeScene scene(disc_image(203.4, 196.2, radius, inside, outside));
  candidates_of(scene);
  double sum = 0;
  int members = 0;
  for (int i = 0; i < scene.map.count; ++i) {
    if (!scene.set.is_member(i) || scene.map[i].isophote_radius() == 0) continue;
    sum += scene.map[i].isophote_radius();
    ++members;
  }
  ASSERT_GT(members, 10);
  EXPECT_NEAR(sum / members / (radius / 2), polarity ? 1 : -1, 0.25);
}

TEST_P(DiscTest, OnlyABrightDiscFitsAsARing) {
  const auto [radius, polarity] = GetParam();
  const int inside = polarity ? 180 : 60, outside = polarity ? 60 : 180;
  EdgeScene scene(disc_image(203.4, 196.2, radius, inside, outside));
  RingCandidate ring;
  bool found = false;
  for (const CircleCandidate& c : candidates_of(scene)) {
    found = found || fit_ring(scene.map, scene.set, c, 24, ring, scene.work);
    if (found) break;
  }
  EXPECT_EQ(found, polarity == 1);
  if (!found) return;
  EXPECT_NEAR(ring.ellipse.cx.raw() / 65536.0, (203.4 - 0.5) / 2, 0.08);
  EXPECT_NEAR(ring.ellipse.cy.raw() / 65536.0, (196.2 - 0.5) / 2, 0.08);
  EXPECT_NEAR(ring.axes.major.raw() / 65536.0, radius / 2, 0.25);
  EXPECT_GE(ring.covered, 30);
}

INSTANTIATE_TEST_SUITE_P(Sizes, DiscTest,
                         testing::Combine(testing::Values(14.0, 25.0, 50.0, 90.0, 150.0),
                                          testing::Values(0, 1)));

TEST(Circles, StraightEdgesDoNotVote) {
  cv::Mat image(400, 400, CV_8U, cv::Scalar(50));
  cv::line(image, {-50, 120}, {450, 330}, cv::Scalar(200), 60);
  cv::GaussianBlur(image, image, {0, 0}, 0.8);
  EdgeScene scene(image);
  EXPECT_GT(scene.set.count, 0);
  EXPECT_TRUE(candidates_of(scene).empty());
}

TEST(Circles, ASteepRingIsFitWithAQuarterOfItHidden) {
  cv::Mat image(500, 500, CV_8U, cv::Scalar(40));
  cv::ellipse(image, {250, 250}, {120, 75}, 30, 0, 360, cv::Scalar(190), -1, cv::LINE_AA);
  cv::ellipse(image, {250, 250}, {96, 60}, 30, 0, 360, cv::Scalar(40), -1, cv::LINE_AA);
  cv::rectangle(image, {250, 100}, {400, 240}, cv::Scalar(110), -1);
  cv::GaussianBlur(image, image, {0, 0}, 0.8);
  EdgeScene scene(image);
  bool found = false;
  for (const CircleCandidate& c : candidates_of(scene)) {
    RingCandidate ring;
    if (!fit_ring(scene.map, scene.set, c, 14, ring, scene.work)) continue;
    if (std::abs(ring.axes.major.raw() / 65536.0 - 60) > 2) continue;
    found = true;
    EXPECT_NEAR(ring.ellipse.cx.raw() / 65536.0, 124.75, 0.5);
    EXPECT_NEAR(ring.axes.minor.raw() / 65536.0, 37.5, 0.7);
  }
  EXPECT_TRUE(found);
}

}  // namespace
}  // namespace berth
