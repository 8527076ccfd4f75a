// Images as the chain takes them.
#include "host_sim/replay/image_input.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace berth::host {
namespace {

TEST(ImageInput, SixteenBitsKeepBlackAndWhite) {
  const cv::Mat raw = (cv::Mat_<std::uint16_t>(1, 4) << 0, 257, 32896, 65535);
  const LoadedImage out = to_gray_8(raw);
  EXPECT_TRUE(out.conversions.from_16_bit);
  EXPECT_EQ(cv::countNonZero(out.image != (cv::Mat_<std::uint8_t>(1, 4) << 0, 1, 128, 255)), 0);
}

TEST(ImageInput, ColorBecomesGrey) {
  const cv::Mat raw(2, 2, CV_8UC3, cv::Scalar(80, 80, 80));
  const LoadedImage out = to_gray_8(raw);
  EXPECT_TRUE(out.conversions.from_color);
  EXPECT_EQ(out.image.at<std::uint8_t>(0, 0), 80);
}

TEST(ImageInput, FloatingPointIsRefused) {
  EXPECT_FALSE(to_gray_8(cv::Mat(2, 2, CV_32FC1)).error.empty());
}

TEST(Binning, IsTheMeanOfTheSquare) {
  const cv::Mat raw =
      (cv::Mat_<std::uint8_t>(3, 5) << 0, 1, 10, 20, 9, 1, 1, 30, 40, 9, 7, 7, 7, 7, 7);
  const cv::Mat out = bin_image(raw, 2);
  ASSERT_EQ(out.size(), cv::Size(2, 1));
  EXPECT_EQ(out.at<std::uint8_t>(0, 0), 1);  // 3/4 up
  EXPECT_EQ(out.at<std::uint8_t>(0, 1), 25);
}

TEST(Binning, SmallestThatFits) {
  EXPECT_EQ(binning_for(1024, 1024), 1);
  EXPECT_EQ(binning_for(1025, 700), 2);
  EXPECT_EQ(binning_for(2048, 2048), 2);
  EXPECT_EQ(binning_for(2049, 2048), 2);  // the last column is cropped
  EXPECT_EQ(binning_for(2050, 2048), 3);
  EXPECT_EQ(binning_for(4096, 3000), 4);
}

}  // namespace
}  // namespace berth::host
