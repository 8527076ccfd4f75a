// Laws of edge detection and linking.
#include <gtest/gtest.h>

#include <set>

#include "edge_scene.hpp"

namespace berth {
namespace {

cv::Mat clutter(int seed) {
  cv::Mat image(300, 300, CV_8U, cv::Scalar(90));
  cv::RNG rng(static_cast<std::uint64_t>(seed));
  for (int k = 0; k < 40; ++k) {
    const cv::Point p(rng.uniform(0, 300), rng.uniform(0, 300));
    if (k % 2)
      cv::circle(image, p, rng.uniform(4, 50), cv::Scalar(rng.uniform(0, 255)), 2);
    else
      cv::line(image, p, {rng.uniform(0, 300), rng.uniform(0, 300)},
               cv::Scalar(rng.uniform(0, 255)), 3);
  }
  cv::GaussianBlur(image, image, {0, 0}, 0.7);
  cv::Mat noise(image.size(), CV_8S);
  rng.fill(noise, cv::RNG::NORMAL, 0, 2);
  cv::add(image, noise, image, cv::noArray(), CV_8U);
  return image;
}

TEST(EdgeMap, FindAgreesWithASearchThroughAllPixels) {
  const EdgeScene scene(clutter(1));
  std::set<std::pair<int, int>> all;
  for (int y = 0; y < scene.map.height; ++y) {
    for (int i = scene.map.row_begin(y); i < scene.map.row_end(y); ++i) {
      EXPECT_EQ(scene.map.find(scene.map[i].x(), y), i);
      all.insert({scene.map[i].x(), y});
    }
  }
  EXPECT_EQ(static_cast<int>(all.size()), scene.map.count);
  for (int y = -2; y < scene.map.height + 2; ++y) {
    for (int x = -2; x < scene.map.width + 2; ++x) {
      EXPECT_EQ(scene.map.find(x, y) != kNoEdge, all.count({x, y}) == 1);
    }
  }
}

TEST(DetectEdges, AFullPoolGivesTheOutcomeOfTheHigherThreshold) {
  const cv::Mat image = clutter(2);
  const EdgeScene small(image, 200, 1500);
  ASSERT_TRUE(small.outcome.pool_full);
  const EdgeScene large(image, small.outcome.threshold);
  ASSERT_FALSE(large.outcome.pool_full);
  ASSERT_EQ(small.map.count, large.map.count);
  for (int i = 0; i < small.map.count; ++i) {
    EXPECT_EQ(small.map[i].x_and_offset, large.map[i].x_and_offset);
    EXPECT_EQ(small.map[i].gx, large.map[i].gx);
  }
  for (int y = 0; y < small.map.height; ++y)
    EXPECT_EQ(small.map.row_begin(y), large.map.row_begin(y));
}

TEST(DetectEdges, PureNoiseLeavesNextToNothing) {
  cv::Mat image(400, 400, CV_8U);
  cv::RNG(3).fill(image, cv::RNG::NORMAL, 120, 5);
  const int threshold = edge_threshold(5 * 256, q<16>(4.5), 2);
  const EdgeScene scene(image, threshold);
  // |gx| + |gy| of 4.5 sigma is 3.2 sigma along a diagonal: a Rayleigh tail of 0.6 % there.
  EXPECT_LT(scene.map.count, 0.005 * scene.map.width * scene.map.height);
}

// Noise alone, so strong that it sets the threshold: at any binning as many pixels come through.
TEST(DetectEdges, TheThresholdFollowsTheBinning) {
  cv::Mat image(1024, 1024, CV_8U);
  cv::RNG(3).fill(image, cv::RNG::NORMAL, 128, 40);
  const ImageView view = view_of(image);
  double share[3];
  for (int level = 0; level < 3; ++level) {
    const int bin = 1 << level, side = std::min(512, 1024 / bin);
    const int threshold = edge_threshold(40 * 256, q<16>(2.5), bin);
    ASSERT_GT(threshold, edge_threshold(0, q<16>(2.5), bin));
    const EdgeScene scene(view, {0, 0, bin, side, side}, threshold, 65000);
    ASSERT_FALSE(scene.outcome.pool_full);
    share[level] = scene.map.count / std::pow(side - 2.0 * kGridBorder, 2);
  }
  EXPECT_NEAR(share[1] / share[0], 1, 0.05);
  EXPECT_NEAR(share[2] / share[0], 1, 0.05);
}

TEST(DetectEdges, SubCellPlacesLieOnTheTrueRim) {
  const double cx = 200.3, cy = 199.6, r = 80.2;
  const EdgeScene scene(disc_image(cx, cy, r, 200, 40));
  ASSERT_GT(scene.map.count, 150);
  double worst = 0, mean = 0;
  for (int y = 0; y < scene.map.height; ++y) {
    for (int i = scene.map.row_begin(y); i < scene.map.row_end(y); ++i) {
      const EdgePixel& p = scene.map[i];
      double u = p.x(), v = y;
      (p.is_steep_in_x() ? u : v) += p.offset() / 64.0;
      const double d = std::hypot(2 * u + 0.5 - cx, 2 * v + 0.5 - cy) - r;
      worst = std::max(worst, std::abs(d));
      mean += d / scene.map.count;
    }
  }
  EXPECT_LT(worst, 0.7);  // a third of a cell
  EXPECT_LT(std::abs(mean), 0.12);
}

TEST(LinkEdges, EachPixelIsVisitedOnceAndMembersAreThoseInChains) {
  const EdgeScene scene(clutter(4));
  std::set<int> seen;
  for (int c = 0; c < scene.set.count; ++c) {
    const Chain chain = scene.set.chains[static_cast<std::size_t>(c)];
    EXPECT_GE(chain.count, kMinChainPixels);
    for (int k = 0; k < chain.count; ++k) {
      const int i = scene.set.order[static_cast<std::size_t>(chain.start + k)];
      EXPECT_TRUE(seen.insert(i).second) << "pixel " << i << " twice";
    }
  }
  for (int i = 0; i < scene.map.count; ++i) EXPECT_EQ(scene.set.is_member(i), seen.count(i) == 1);
}

TEST(LinkEdges, StepsGoToNeighboursAndKeepTheBrightSideToOneHand) {
  const EdgeScene scene(clutter(5));
  for (int c = 0; c < scene.set.count; ++c) {
    const Chain chain = scene.set.chains[static_cast<std::size_t>(c)];
    for (int k = 1; k < chain.count; ++k) {
      const int a = scene.set.order[static_cast<std::size_t>(chain.start + k - 1)];
      const int b = scene.set.order[static_cast<std::size_t>(chain.start + k)];
      const EdgePixel &p = scene.map[a], &q = scene.map[b];
      const int dx = q.x() - p.x();
      const int dy = scene.set.row_of[static_cast<std::size_t>(b)] -
                     scene.set.row_of[static_cast<std::size_t>(a)];
      EXPECT_LE(std::max(std::abs(dx), std::abs(dy)), 2);  // 2: over a gap
      // Tangent (-gy, gx) of the pixel it leaves, within a quantised octant: never backwards.
      const double along = -p.gy * dx + p.gx * dy;
      const double across = p.gx * dx + p.gy * dy;
      const double along2 = -q.gy * dx + q.gx * dy;
      EXPECT_TRUE(along > -std::abs(across) * 0.5 || along2 > -std::abs(across) * 0.5);
    }
  }
}

TEST(LinkEdges, ADiscIsOneChainAllTheWayRound) {
  for (const double phase : {0.0, 0.25, 0.5, 0.75}) {
    const EdgeScene scene(disc_image(200 + phase, 200 - phase, 90, 180, 60));
    ASSERT_EQ(scene.set.count, 1) << phase;
    EXPECT_GT(scene.set.chains[0].count, 0.85 * 2 * CV_PI * 45 * 2 * std::sqrt(2) / CV_PI);
  }
}

// The ridge of a corner juts out: a chain that follows it comes to nothing there.
TEST(LinkEdges, ACornerDoesNotCutTheChain) {
  for (int angle = 0; angle < 90; ++angle) {
    const cv::RotatedRect shape({200.3f, 199.6f}, {190, 36}, static_cast<float>(angle));
    cv::Point2f corners[4];
    shape.points(corners);
    std::vector<cv::Point> outline;
    for (const cv::Point2f& c : corners) outline.emplace_back(c * 16.0f);
    cv::Mat image(400, 400, CV_8U, cv::Scalar(50));
    cv::fillConvexPoly(image, outline, cv::Scalar(190), cv::LINE_AA, 4);
    cv::GaussianBlur(image, image, {0, 0}, 0.8);
    const EdgeScene scene(image);
    EXPECT_EQ(scene.set.count, 1) << angle;
  }
}

TEST(LinkEdges, StepsAreLittleMoreThanPixels) {
  const EdgeScene scene(clutter(8));
  int members = 0;
  for (int i = 0; i < scene.map.count; ++i) members += scene.set.is_member(i);
  EXPECT_GE(scene.set.steps, members);
  EXPECT_LT(scene.set.steps, 1.3 * members);
}

TEST(LinkEdges, ChainsAreOnePixelWide) {
  const EdgeScene scene(clutter(6));
  cv::Mat mask = cv::Mat::zeros(scene.map.height, scene.map.width, CV_8U);
  int members = 0;
  for (int y = 0; y < scene.map.height; ++y) {
    for (int i = scene.map.row_begin(y); i < scene.map.row_end(y); ++i) {
      if (!scene.set.is_member(i)) continue;
      mask.at<std::uint8_t>(y, scene.map[i].x()) = 1;
      ++members;
    }
  }
  int blocks = 0;
  for (int y = 0; y + 1 < mask.rows; ++y) {
    for (int x = 0; x + 1 < mask.cols; ++x)
      blocks += cv::countNonZero(mask(cv::Rect(x, y, 2, 2))) == 4;
  }
  EXPECT_LT(blocks, 0.02 * members);
}

TEST(LinkEdges, AFullChainPoolIsReported) {
  const EdgeScene scene(clutter(7), 512, 30000, 3);
  EXPECT_TRUE(scene.set.pool_full);
  EXPECT_EQ(scene.set.count, 3);
}

}  // namespace
}  // namespace berth
