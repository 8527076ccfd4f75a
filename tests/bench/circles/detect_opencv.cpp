#include <algorithm>
#include <chrono>
#include <opencv2/imgproc.hpp>
#include <opencv2/ximgproc/edge_drawing.hpp>

#include "bench/circles/allocation_peak.hpp"
#include "bench/circles/detectors.hpp"
#include "bench/circles/randomized_hough.hpp"
#include "bench/edges/detectors.hpp"

namespace berth::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kRadiusMin_px = 20, kRadiusMax_px = 150;
constexpr double kScharrPerSobel = 4;  // gain of HOUGH_GRADIENT_ALT's operator over Canny's

template <typename Find>
CircleDetection measure(Find find) {
  CircleDetection detection;
  const AllocationPeak peak;
  const auto start = Clock::now();
  detection.circles = find();
  const std::chrono::duration<double, std::milli> time = Clock::now() - start;
  detection.time_ms = time.count();
  detection.bytes = peak.bytes();
  return detection;
}

cv::Mat blurred(const cv::Mat& image) {
  cv::Mat out;
  cv::GaussianBlur(image, out, {5, 5}, 1.0);
  return out;
}

FoundCircle circle_of(double x, double y, double radius) { return {{x, y}, radius, radius, true}; }

struct HoughOptions {
  int method;
  double dp, edge_threshold, accumulator;
};

std::vector<FoundCircle> find_hough(const cv::Mat& image, const HoughOptions& o) {
  std::vector<cv::Vec3f> circles;
  cv::HoughCircles(blurred(image), circles, o.method, o.dp, 20, o.edge_threshold, o.accumulator,
                   kRadiusMin_px, kRadiusMax_px);
  std::vector<FoundCircle> found;
  for (const cv::Vec3f& c : circles) found.push_back(circle_of(c[0], c[1], c[2]));
  return found;
}

std::vector<FoundCircle> find_drawn(const cv::Mat& image) {
  const auto drawing = cv::ximgproc::createEdgeDrawing();
  drawing->params.EdgeDetectionOperator = cv::ximgproc::EdgeDrawing::SOBEL;
  drawing->params.GradientThresholdValue = cvRound(fair_threshold(image));
  drawing->params.AnchorThresholdValue = cvRound(fair_threshold(image) * 8 / 36);
  drawing->detectEdges(image);
  std::vector<cv::Vec6d> ellipses;
  drawing->detectEllipses(ellipses);
  std::vector<FoundCircle> found;
  for (const cv::Vec6d& e : ellipses) {
    if (e[2] > 0) {
      found.push_back({{e[0], e[1]}, e[2], e[2], false});
    } else {
      found.push_back({{e[0], e[1]}, std::max(e[3], e[4]), std::min(e[3], e[4]), false});
    }
  }
  return found;
}

std::vector<FoundCircle> find_randomized(const cv::Mat& image) {
  const double low = fair_threshold(image);
  cv::Mat edges;
  cv::Canny(blurred(image), edges, low, 1.5 * low);
  std::vector<FoundCircle> found;
  for (const cv::Vec3d& c : randomized_hough(edges, {}, 1)) {
    found.push_back(circle_of(c[0], c[1], c[2]));
  }
  return found;
}

}  // namespace

CircleDetector make_hough_gradient(bool is_fair) {
  return {
      is_fair ? "HOUGH_GRADIENT, threshold from noise" : "HOUGH_GRADIENT, as in the manual",
      [=](const cv::Mat& image) {
        const double threshold = is_fair ? 1.5 * fair_threshold(image) : 200;
        return measure([&] { return find_hough(image, {cv::HOUGH_GRADIENT, 2, threshold, 100}); });
      }};
}

CircleDetector make_hough_gradient_alt(bool is_fair) {
  return {
      is_fair ? "HOUGH_GRADIENT_ALT, threshold from noise" : "HOUGH_GRADIENT_ALT, as in the manual",
      [=](const cv::Mat& image) {
        const double threshold = is_fair ? kScharrPerSobel * 1.5 * fair_threshold(image) : 300;
        return measure([&] {
          return find_hough(image, {cv::HOUGH_GRADIENT_ALT, 1.5, threshold, is_fair ? 0.8 : 0.9});
        });
      }};
}

CircleDetector make_drawn_ellipses() {
  return {"EdgeDrawing, ellipses",
          [](const cv::Mat& image) { return measure([&] { return find_drawn(image); }); }};
}

CircleDetector make_randomized_hough() {
  return {"randomized Hough",
          [](const cv::Mat& image) { return measure([&] { return find_randomized(image); }); }};
}

std::vector<CircleDetector> all_circle_detectors() {
  return {make_ours(false),
          make_ours(true),
          make_hough_gradient(true),
          make_hough_gradient(false),
          make_hough_gradient_alt(true),
          make_hough_gradient_alt(false),
          make_drawn_ellipses(),
          make_randomized_hough()};
}

}  // namespace berth::bench
