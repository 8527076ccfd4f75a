// The gradient on line buffers against OpenCV's separable filter in double.
#include <gtest/gtest.h>

#include <memory>
#include <opencv2/imgproc.hpp>

#include "image/gradient_rows.hpp"

namespace berth {
namespace {

cv::Mat noise_image(int width, int height, int seed) {
  cv::Mat image(height, width, CV_8U);
  cv::RNG rng(static_cast<std::uint64_t>(seed));
  rng.fill(image, cv::RNG::UNIFORM, 0, 256);
  return image;
}

ImageView view_of(const cv::Mat& m) {
  ImageView v;
  v.pixels = m.data;
  v.width = m.cols;
  v.height = m.rows;
  v.stride = static_cast<int>(m.step);
  return v;
}

// Gradient in units of 128 per DN and cell, by OpenCV.
void reference_gradient(const cv::Mat& image, int bin, cv::Mat& gx, cv::Mat& gy) {
  cv::Mat cells;
  image.convertTo(cells, CV_64F);
  if (bin == 2) {
    cv::resize(cells, cells, {image.cols / 2, image.rows / 2}, 0, 0, cv::INTER_AREA);
  }
  const cv::Mat smooth = (cv::Mat_<double>(1, 5) << 1, 4, 6, 4, 1) / 16;
  const cv::Mat slope = (cv::Mat_<double>(1, 5) << -1, -2, 0, 2, 1) / 8;
  cv::sepFilter2D(cells * 128, gx, CV_64F, slope, smooth);
  cv::sepFilter2D(cells * 128, gy, CV_64F, smooth, slope);
}

class GradientRowsTest : public testing::TestWithParam<int> {};

TEST_P(GradientRowsTest, EqualsOpenCvWithinTheStatedRounding) {
  const int bin = GetParam();
  const cv::Mat image = noise_image(200, 120, bin);
  const ImageView view = view_of(image);
  const SearchGrid grid{0, 0, bin, image.cols / bin, image.rows / bin};
  cv::Mat gx, gy;
  reference_gradient(image, bin, gx, gy);
  auto rows = std::make_unique<GradientRows>();
  double worst = 0;
  for (int y = 0; y < grid.height; ++y) {
    bin_row(view, grid, y, *rows);
    if (y < 4) continue;
    differentiate_row(grid, y - 2, *rows);
    const GradientRow& row = rows->row(y - 2);
    for (int x = 2; x < grid.width - 2; ++x) {
      worst = std::max(worst, std::abs(row.gx[x] - gx.at<double>(y - 2, x)));
      worst = std::max(worst, std::abs(row.gy[x] - gy.at<double>(y - 2, x)));
      EXPECT_EQ(row.magnitude[x], std::abs(row.gx[x]) + std::abs(row.gy[x]));
    }
  }
  // Half a unit for each of the 4 (6) weighted column sums: 3 of 128 for gx, 8 for gy.
  EXPECT_LE(worst, 8.0);
}

INSTANTIATE_TEST_SUITE_P(Binning, GradientRowsTest, testing::Values(1, 2));

TEST(GradientRows, ARampHasItsSlopeEverywhere) {
  cv::Mat image(64, 64, CV_8U);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x)
      image.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(2 * x + y);
  }
  const ImageView view = view_of(image);
  const SearchGrid grid = whole_frame(view);
  auto rows = std::make_unique<GradientRows>();
  for (int y = 0; y < 5; ++y) bin_row(view, grid, y, *rows);
  differentiate_row(grid, 2, *rows);
  for (int x = 2; x < grid.width - 2; ++x) {
    EXPECT_EQ(rows->row(2).gx[x], 4 * kGradientUnit);  // 2 DN per pixel are 4 per cell
    EXPECT_EQ(rows->row(2).gy[x], 2 * kGradientUnit);
  }
}

TEST(GradientRows, ExtremesStayInSixteenBits) {
  // The largest gradient the kernels can see: a step of 255 DN along each axis.
  cv::Mat image = cv::Mat::zeros(64, 64, CV_8U);
  image.colRange(32, 64).setTo(255);
  const ImageView view = view_of(image);
  const SearchGrid grid = whole_frame(view);
  auto rows = std::make_unique<GradientRows>();
  for (int y = 0; y < 5; ++y) bin_row(view, grid, y, *rows);
  differentiate_row(grid, 2, *rows);
  int largest = 0;
  for (int x = 2; x < grid.width - 2; ++x) largest = std::max<int>(largest, rows->row(2).gx[x]);
  EXPECT_EQ(largest, 255 * kGradientUnit * 3 / 8);  // weights 2 and 1 of 8 on the bright side
}

TEST(GradientRows, ComplementHasTheOppositeGradient) {
  const cv::Mat image = noise_image(64, 32, 7);
  const cv::Mat complement = 255 - image;
  ImageView plain = view_of(image), inverted = view_of(complement);
  inverted.polarity_mask = 0xff;
  const SearchGrid grid = whole_frame(plain);
  auto a = std::make_unique<GradientRows>(), b = std::make_unique<GradientRows>();
  for (int y = 0; y < 5; ++y) {
    bin_row(plain, grid, y, *a);
    bin_row(inverted, grid, y, *b);
  }
  differentiate_row(grid, 2, *a);
  differentiate_row(grid, 2, *b);
  for (int x = 0; x < grid.width; ++x) EXPECT_EQ(a->row(2).gx[x], b->row(2).gx[x]);
}

}  // namespace
}  // namespace berth
