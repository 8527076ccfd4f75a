// The measured noise against the noise that was put in.
#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "common/view_of.hpp"
#include "image/noise.hpp"

namespace berth {
namespace {

double measured(const cv::Mat& image) { return measure_noise_q8(view_of(image)) / 256.0; }

cv::Mat with_noise(const cv::Mat& base, double sigma) {
  cv::Mat noise(base.size(), CV_64F), sum;
  cv::RNG rng(11);
  rng.fill(noise, cv::RNG::NORMAL, 0, sigma);
  base.convertTo(sum, CV_64F);
  sum += noise;
  cv::Mat out;
  sum.convertTo(out, CV_8U);
  return out;
}

class NoiseTest : public testing::TestWithParam<double> {};

TEST_P(NoiseTest, IsFoundWithinTenPercentOnAFlatFrame) {
  const double sigma = GetParam();
  const cv::Mat flat(512, 512, CV_8U, cv::Scalar(120));
  const double total = std::sqrt(sigma * sigma + 1.0 / 12);  // rounding to whole DN adds its own
  EXPECT_NEAR(measured(with_noise(flat, sigma)), total, 0.1 * total);
}

TEST_P(NoiseTest, IsNotMistakenForStructure) {
  const double sigma = GetParam();
  cv::Mat scene(512, 512, CV_8U, cv::Scalar(60));
  cv::RNG rng(5);
  for (int k = 0; k < 60; ++k) {
    cv::circle(scene, {rng.uniform(0, 512), rng.uniform(0, 512)}, rng.uniform(5, 40),
               cv::Scalar(rng.uniform(40, 200)), rng.uniform(0, 2) ? -1 : 3, cv::LINE_AA);
  }
  const double total = std::sqrt(sigma * sigma + 1.0 / 12);
  EXPECT_NEAR(measured(with_noise(scene, sigma)), total, 0.3 * total);
}

INSTANTIATE_TEST_SUITE_P(Sigma, NoiseTest, testing::Values(0.5, 1.0, 2.0, 4.0, 6.0, 20.0));

TEST(Noise, ClippedPlacesDoNotCount) {
  cv::Mat half(512, 512, CV_8U, cv::Scalar(255));
  with_noise(cv::Mat(256, 512, CV_8U, cv::Scalar(100)), 5).copyTo(half.rowRange(0, 256));
  EXPECT_NEAR(measured(half), 5, 0.7);
}

TEST(Noise, AFrameWithoutNoiseHasThatOfRounding) {
  EXPECT_NEAR(measured(cv::Mat(64, 64, CV_8U, cv::Scalar(80))), std::sqrt(1.0 / 12), 0.01);
  EXPECT_NEAR(measured(cv::Mat(64, 64, CV_8U, cv::Scalar(0))), std::sqrt(1.0 / 12), 0.01);
}

}  // namespace
}  // namespace berth
