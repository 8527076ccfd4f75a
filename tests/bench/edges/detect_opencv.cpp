#include <chrono>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/ximgproc/edge_drawing.hpp>

#include "bench/edges/detectors.hpp"
#include "bench/edges/follow.hpp"
#include "common/view_of.hpp"
#include "image/noise.hpp"

namespace berth::bench {
namespace {

using Clock = std::chrono::steady_clock;
using Milliseconds = std::chrono::duration<double, std::milli>;

constexpr double kSigmas = 4.5;           // as our own threshold
constexpr double kLeastSlope = 8;         // 1 DN per pixel behind a Sobel operator
constexpr double kAnchorShare = 8. / 36;  // Topal, Akinlar 2012: anchors 8 where edges are 36
constexpr int kLeastChain = 6;            // as our own chains

cv::Mat blurred(const cv::Mat& image) {
  cv::Mat out;
  cv::GaussianBlur(image, out, {5, 5}, 1.0);
  return out;
}

// Standard deviation of one gradient component under white noise of 1 DN.
double noise_gain() {
  cv::Mat impulse = cv::Mat::zeros(15, 15, CV_64F), smooth, slope;
  impulse.at<double>(7, 7) = 1;
  cv::GaussianBlur(impulse, smooth, {5, 5}, 1.0);
  cv::Sobel(smooth, slope, CV_64F, 1, 0);
  return cv::norm(slope);
}

void keep_pixels(const std::vector<cv::Point>& pixels, Detection& detection) {
  PixelChain chain;
  chain.pixels = pixels;
  for (const cv::Point& p : pixels) chain.places_px.push_back(centre_of(p, 1));
  detection.chains.push_back(std::move(chain));
}

Detection draw_edges(const cv::Mat& image, bool is_fair, cv::ximgproc::EdgeDrawing& drawing) {
  const auto start = Clock::now();
  auto& p = drawing.params;
  if (is_fair) {
    p.EdgeDetectionOperator = cv::ximgproc::EdgeDrawing::SOBEL;
    p.GradientThresholdValue = static_cast<int>(std::lround(fair_threshold(image)));
    p.AnchorThresholdValue = static_cast<int>(std::lround(kAnchorShare * p.GradientThresholdValue));
    p.MinPathLength = kLeastChain;
  }
  drawing.detectEdges(image);
  const auto segments = drawing.getSegments();
  const Milliseconds time = Clock::now() - start;
  Detection detection;
  detection.grid = image.size();
  detection.time_ms = time.count();
  for (const auto& segment : segments) keep_pixels(segment, detection);
  cv::Mat magnitude;
  drawing.getGradientImage(magnitude);
  detection.steps = count_drawing_steps(blurred(image), magnitude, p.GradientThresholdValue,
                                        p.AnchorThresholdValue);
  return detection;
}

Detection follow_canny(const cv::Mat& image, bool is_fair) {
  const auto start = Clock::now();
  double low = 50, high = 150;
  cv::Mat smooth, edges;
  if (is_fair) {
    low = fair_threshold(image);
    high = 1.5 * low;
    smooth = blurred(image);
  } else {
    cv::blur(image, smooth, {3, 3});
  }
  cv::Canny(smooth, edges, low, high);
  Detection detection;
  const auto chains = follow_contours(edges, kLeastChain, detection.steps);
  const Milliseconds time = Clock::now() - start;
  detection.grid = image.size();
  detection.time_ms = time.count();
  detection.steps += cv::countNonZero(edges);  // the hysteresis stood once on each of them
  for (const auto& chain : chains) keep_pixels(chain, detection);
  return detection;
}

}  // namespace

double fair_threshold(const cv::Mat& image) {
  static const double gain = noise_gain();
  return std::max(kSigmas * gain * measure_noise_q8(view_of(image)) / 256, kLeastSlope);
}

Detector make_edge_drawing(bool is_fair) {
  const cv::Ptr<cv::ximgproc::EdgeDrawing> drawing = cv::ximgproc::createEdgeDrawing();
  return {is_fair ? "EdgeDrawing, threshold from noise" : "EdgeDrawing, defaults",
          [=](const cv::Mat& image) { return draw_edges(image, is_fair, *drawing); }};
}

Detector make_canny(bool is_fair) {
  return {is_fair ? "Canny and following, threshold from noise" : "Canny and following, 50 and 150",
          [=](const cv::Mat& image) { return follow_canny(image, is_fair); }};
}

std::vector<Detector> all_detectors() {
  return {make_ours(1),     make_edge_drawing(true), make_edge_drawing(false),
          make_canny(true), make_canny(false),       make_ours(2),
          make_ours(4)};
}

}  // namespace berth::bench
