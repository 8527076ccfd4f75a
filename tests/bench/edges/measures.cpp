#include "bench/edges/measures.hpp"

#include <cmath>

namespace berth::bench {
namespace {

bool is_block(const cv::Mat& mask, int x, int y) {
  return mask.at<uchar>(y, x) && mask.at<uchar>(y, x + 1) && mask.at<uchar>(y + 1, x) &&
         mask.at<uchar>(y + 1, x + 1);
}

// The angle from one direction to the other, -pi .. pi.
double angle_between(cv::Point2d a, cv::Point2d b) { return std::atan2(a.cross(b), a.dot(b)); }

template <typename Point>
Mean mean_turning_deg(const std::vector<Point>& points) {
  Mean mean;
  const int count = static_cast<int>(points.size());
  if (count < 3 * kBaseline) return mean;
  const auto chord = [&](int i) {
    return points[static_cast<size_t>(i + kBaseline)] - points[static_cast<size_t>(i)];
  };
  for (int i = 0; i + kBaseline + 1 < count; ++i) {
    mean.add(std::abs(angle_between(chord(i), chord(i + 1))) * 180 / CV_PI);
  }
  return mean;
}

}  // namespace

Mean block_share(const Detection& detection) {
  cv::Mat mask = cv::Mat::zeros(detection.grid, CV_8U);
  for (const PixelChain& chain : detection.chains) {
    for (const cv::Point& p : chain.pixels) mask.at<uchar>(p) = 1;
  }
  cv::Mat thick = cv::Mat::zeros(detection.grid, CV_8U);
  for (int y = 0; y + 1 < mask.rows; ++y) {
    for (int x = 0; x + 1 < mask.cols; ++x) {
      if (is_block(mask, x, y)) thick(cv::Rect(x, y, 2, 2)) = 1;
    }
  }
  return {static_cast<double>(cv::countNonZero(thick)),
          static_cast<double>(cv::countNonZero(mask))};
}

Mean turning_deg(const std::vector<cv::Point>& pixels) { return mean_turning_deg(pixels); }
Mean turning_deg(const std::vector<cv::Point2d>& places_px) { return mean_turning_deg(places_px); }

Mean turning_deg(const Detection& detection) {
  Mean mean;
  for (const PixelChain& chain : detection.chains) mean.merge(turning_deg(chain.pixels));
  return mean;
}

}  // namespace berth::bench
