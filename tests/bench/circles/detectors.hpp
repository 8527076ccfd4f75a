// The circle detectors that are compared, each as a function of an 8-bit image.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/circles/found_circle.hpp"

namespace berth::bench {

struct CircleDetection {
  std::vector<FoundCircle> circles;
  double time_ms = 0;
  std::size_t bytes = 0;  // the algorithm's own data at their worst, without the image
};

struct CircleDetector {
  std::string name;
  std::function<CircleDetection(const cv::Mat&)> detect;
};

/// Stages 1 and 2 of the chain on the flight grid: rings from arcs, or from arcs and votes.
CircleDetector make_ours(bool with_votes);

/// cv::HoughCircles, radii 20 to 150 px, on the image behind a 5 x 5 Gaussian blur of 1 px. As in
/// OpenCV's manual (HOUGH_GRADIENT: dp 2, 200, 100; HOUGH_GRADIENT_ALT: dp 1.5, 300, 0.9), or with
/// Canny's upper threshold from the measured noise (and 0.8, which the manual names for less
/// perfect circles; a lower accumulator threshold for HOUGH_GRADIENT brings hundreds of false
/// circles).
CircleDetector make_hough_gradient(bool is_fair);
CircleDetector make_hough_gradient_alt(bool is_fair);

/// cv::ximgproc::EdgeDrawing::detectEllipses with the threshold from the measured noise.
CircleDetector make_drawn_ellipses();

/// A plain randomized Hough transform (randomized_hough.hpp) on Canny's edges, threshold from the
/// measured noise.
CircleDetector make_randomized_hough();

std::vector<CircleDetector> all_circle_detectors();

}  // namespace berth::bench
