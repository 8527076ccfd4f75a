// Region growing against OpenCV's connected components.
#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "common/view_of.hpp"
#include "marker/grow_region.hpp"

namespace berth {
namespace {

cv::Mat ellipse_image(cv::Size axes, double angle) {
  cv::Mat image(120, 120, CV_8U, cv::Scalar(30));
  cv::ellipse(image, {60, 58}, axes, angle, 0, 360, cv::Scalar(200), -1);
  return image;
}

TEST(GrowRegion, TakesTheWholeConvexBlob) {
  for (const double angle : {0.0, 30.0, 70.0, 120.0}) {
    const cv::Mat image = ellipse_image({30, 18}, angle);
    cv::Mat labels, stats, centers;
    cv::connectedComponentsWithStats(image > 100, labels, stats, centers, 4);
    const Region r = grow_region(view_of(image), {5, 5, 114, 114}, 60, 58, {100, false});
    EXPECT_EQ(r.area, stats.at<int>(1, cv::CC_STAT_AREA));
    EXPECT_EQ(r.x0, stats.at<int>(1, cv::CC_STAT_LEFT));
    EXPECT_EQ(r.y1 - r.y0 + 1, stats.at<int>(1, cv::CC_STAT_HEIGHT));
    EXPECT_FALSE(r.touches_border);
  }
}

TEST(GrowRegion, ABlobThatLeavesTheWindowTouchesItsBorder) {
  const Region r =
      grow_region(view_of(ellipse_image({30, 18}, 0)), {40, 40, 80, 80}, 60, 58, {100, false});
  EXPECT_TRUE(r.touches_border);
}

TEST(GrowRegion, ADarkSeedGrowsNothing) {
  EXPECT_EQ(
      grow_region(view_of(ellipse_image({30, 18}, 0)), {5, 5, 114, 114}, 10, 10, {100, false}).area,
      0);
}

TEST(GrowRegion, MeansHoldTogetherWhatNoiseTearsApart) {
  cv::Mat image(120, 120, CV_8U, cv::Scalar(60));
  cv::circle(image, {60, 60}, 14, cv::Scalar(84), -1);
  cv::Mat noise(image.size(), CV_8S);
  cv::RNG(4).fill(noise, cv::RNG::NORMAL, 0, 6);
  cv::add(image, noise, image, cv::noArray(), CV_8U);
  const Region r = grow_region(view_of(image), {30, 30, 90, 90}, 60, 60, {72, true});
  EXPECT_NEAR(r.area, CV_PI * 14 * 14, 0.15 * CV_PI * 14 * 14);
}

}  // namespace
}  // namespace berth
