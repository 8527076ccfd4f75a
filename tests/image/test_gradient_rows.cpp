// The gradient on line buffers against OpenCV's separable filter in double.
#include <gtest/gtest.h>

#include <memory>
#include <opencv2/imgproc.hpp>

#include "common/view_of.hpp"
#include "image/gradient_rows.hpp"

namespace berth {
namespace {

cv::Mat noise_image(int width, int height, int seed) {
  cv::Mat image(height, width, CV_8U);
  cv::RNG rng(static_cast<std::uint64_t>(seed));
  rng.fill(image, cv::RNG::UNIFORM, 0, 256);
  return image;
}

// Gradient in units of 128 per DN and cell, by OpenCV.
void reference_gradient(const cv::Mat& image, int bin, cv::Mat& gx, cv::Mat& gy) {
  cv::Mat cells;
  image.convertTo(cells, CV_64F);
  if (bin > 1) {
    cv::resize(cells, cells, {image.cols / bin, image.rows / bin}, 0, 0, cv::INTER_AREA);
  }
  const cv::Mat smooth = (cv::Mat_<double>(1, 5) << 1, 4, 6, 4, 1) / 16;
  const cv::Mat slope = (cv::Mat_<double>(1, 5) << -1, -2, 0, 2, 1) / 8;
  cv::sepFilter2D(cells * 128, gx, CV_64F, slope, smooth);
  cv::sepFilter2D(cells * 128, gy, CV_64F, smooth, slope);
}

// Gradients of row y once all rows up to y + 2 have been read, by column.
class Row {
 public:
  Row(const GradientRows& rows, int width, int y) : rows_(rows), layout_(width), y_(y) {}
  int gx(int x) const { return lane(x).gx(); }
  int gy(int x) const { return lane(x).gy(); }
  int magnitude(int x) const { return lane(x).magnitude(); }

 private:
  GradientLane lane(int x) const {
    return rows_.row(y_)[layout_.word_of(x)].lane(layout_.lane_of(x));
  }
  const GradientRows& rows_;
  RowLayout layout_;
  int y_;
};

std::unique_ptr<GradientRows> rows_after(const ImageView& view, const SearchGrid& grid, int last) {
  auto rows = std::make_unique<GradientRows>();
  for (int y = 0; y <= last; ++y) smooth_row(view, grid, y, *rows);
  return rows;
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
  double worst = 0, squares = 0;
  int count = 0;
  for (int y = 0; y < grid.height; ++y) {
    smooth_row(view, grid, y, *rows);
    if (y < 4) continue;
    differentiate_row(grid.width, y - 2, 512, *rows);
    const Row row(*rows, grid.width, y - 2);
    for (int x = 2; x < grid.width - 2; ++x) {
      const double ex = row.gx(x) - gx.at<double>(y - 2, x);
      const double ey = row.gy(x) - gy.at<double>(y - 2, x);
      worst = std::max({worst, std::abs(ex), std::abs(ey)});
      squares += ex * ex + ey * ey;
      count += 2;
      EXPECT_EQ(row.magnitude(x), std::abs(row.gx(x)) + std::abs(row.gy(x)));
    }
  }
  // Weights of +-48 units on cells cut by up to 0.5 DN, or 1 DN, and by 0.25 in the sums of two;
  // those of 8 on S.
  EXPECT_LE(worst, bin == 4 ? 56.0 : bin == 2 ? 26.0 : 2.0);
  EXPECT_LE(std::sqrt(squares / count), bin > 1 ? 5.0 : 1.0);
}

INSTANTIATE_TEST_SUITE_P(Binning, GradientRowsTest, testing::Values(1, 2, 4));

// Every width: each column is computed, by the lane that says so, and nothing outside is touched.
TEST(GradientRows, EveryColumnOfEveryWidthIsThere) {
  const cv::Mat image = noise_image(1024, 12, 3);
  const ImageView view = view_of(image);
  cv::Mat all_gx, all_gy;
  reference_gradient(image, 1, all_gx, all_gy);
  for (int width = kMinGridWidth; width <= 1024; width += width < 40 ? 1 : 37) {
    const SearchGrid grid{0, 0, 1, width, 12};
    const auto rows = rows_after(view, grid, 5);
    differentiate_row(width, 3, 512, *rows);
    const Row row(*rows, width, 3);
    for (int x = 2; x < width - 2; ++x) {
      ASSERT_NEAR(row.gx(x), all_gx.at<double>(3, x), 2.0) << width << " " << x;
      ASSERT_NEAR(row.gy(x), all_gy.at<double>(3, x), 2.0) << width << " " << x;
    }
  }
}

TEST(GradientRows, StrongWordsAreThoseThatReachTheThreshold) {
  const cv::Mat image = noise_image(400, 30, 4);
  const ImageView view = view_of(image);
  const SearchGrid grid = whole_frame(view);
  const auto rows = rows_after(view, grid, 6);
  const RowLayout layout(grid.width);
  for (const int threshold : {1, 700, 2000, 5000, 24480, 32767}) {
    const auto again = std::make_unique<GradientRows>(*rows);
    differentiate_row(grid.width, 4, threshold, *again);
    std::vector<int> expected;
    for (int k = kGridBorder; k < layout.words - kGridBorder; ++k) {
      const GradientWord& word = again->row(4)[k];
      if (std::max(word.lane(0).magnitude(), word.lane(1).magnitude()) >= threshold) {
        expected.push_back(k);
      }
    }
    std::vector<int> found;
    for (const int k : again->strong(4)) {
      if (k >= kGridBorder && k < layout.words - kGridBorder) found.push_back(k);
    }
    EXPECT_EQ(found, expected) << threshold;
  }
}

TEST(GradientRows, ARampHasItsSlopeEverywhere) {
  cv::Mat image(64, 64, CV_8U);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x)
      image.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(2 * x + y);
  }
  const ImageView view = view_of(image);
  for (const SearchGrid& grid : {whole_frame(view), coarser(whole_frame(view))}) {
    const auto rows = rows_after(view, grid, 4);
    differentiate_row(grid.width, 2, 512, *rows);
    const Row row(*rows, grid.width, 2);
    for (int x = 2; x < grid.width - 2; ++x) {
      EXPECT_EQ(row.gx(x), 2 * grid.bin * kGradientUnit);  // DN per cell
      EXPECT_EQ(row.gy(x), grid.bin * kGradientUnit);
    }
  }
}

TEST(GradientRows, ExtremesStayInSixteenBits) {
  // The largest gradient the kernels can see: a step of 255 DN along each axis.
  cv::Mat image = cv::Mat::zeros(64, 64, CV_8U);
  image.colRange(32, 64).setTo(255);
  const ImageView view = view_of(image);
  const SearchGrid grid = whole_frame(view);
  const auto rows = rows_after(view, grid, 4);
  differentiate_row(grid.width, 2, 512, *rows);
  const Row row(*rows, grid.width, 2);
  int largest = 0;
  for (int x = 2; x < grid.width - 2; ++x) largest = std::max(largest, row.gx(x));
  EXPECT_EQ(largest, 255 * kGradientUnit * 3 / 8);  // weights 2 and 1 of 8 on the bright side
}

TEST(GradientRows, ComplementHasTheOppositeGradient) {
  const cv::Mat image = noise_image(64, 32, 7);
  const cv::Mat complement = 255 - image;
  ImageView plain = view_of(image), inverted = view_of(complement);
  inverted.polarity_mask = 0xff;
  for (const SearchGrid& grid : {whole_frame(plain), coarser(whole_frame(plain))}) {
    const auto a = rows_after(plain, grid, 4), b = rows_after(inverted, grid, 4);
    differentiate_row(grid.width, 2, 512, *a);
    differentiate_row(grid.width, 2, 512, *b);
    const Row of_plain(*a, grid.width, 2), of_inverted(*b, grid.width, 2);
    for (int x = 2; x < grid.width - 2; ++x) EXPECT_EQ(of_plain.gx(x), of_inverted.gx(x));
  }
}

}  // namespace
}  // namespace berth
