// The edge detectors that are compared, each as a function of an 8-bit image.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/edges/pixel_chains.hpp"

namespace berth::bench {

struct Detector {
  std::string name;
  std::function<Detection(const cv::Mat&)> detect;
};

/// detect_edges and link_edges with the chain's own threshold, on a grid binned by `bin`. Binning
/// is the greater part of our smoothing; at full resolution [1 2 1] / 4 both ways takes its place,
/// which makes the kernels as wide as the others' (noise 0.136 of a unit slope, theirs 0.145).
Detector make_ours(int bin);

/// cv::ximgproc::EdgeDrawing as it comes (Prewitt, gradient threshold 20, anchor threshold 0), or
/// with the threshold of `fair_threshold`.
Detector make_edge_drawing(bool is_fair);

/// cv::Canny and a plain contour following. As it comes: 3 x 3 blur, 50 and 150 (OpenCV's
/// tutorial has no other default); or with `fair_threshold`, the upper one half as high again, as
/// our anchors are.
Detector make_canny(bool is_fair);

/// All of them, the flight configuration last.
std::vector<Detector> all_detectors();

/// What our own threshold is, in units of the 3 x 3 Sobel operator behind a 5 x 5 Gaussian blur of
/// 1 px: 4.5 standard deviations of one gradient component, by the noise measured in the image and
/// the operator's own gain, and at least 1 DN per pixel.
double fair_threshold(const cv::Mat& image);

}  // namespace berth::bench
