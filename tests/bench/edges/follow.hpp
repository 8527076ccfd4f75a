// Walks over edge images: a plain contour following, and Edge Drawing's walk with its steps
// counted.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace berth::bench {

/// Chains of the pixels set in `edges`: from line ends first, then from what is left, always to the
/// neighbour that turns least; every pixel once. Chains below `least` pixels are dropped. `steps`
/// counts how often the walk stood on a pixel.
std::vector<std::vector<cv::Point>> follow_contours(const cv::Mat& edges, int least, double& steps);

/// How often Edge Drawing's walk (Topal, Akinlar 2012; OpenCV's form: anchors in the order of their
/// gradient, two directions tried wherever the edge turns) stands on a pixel. `magnitude`: 16-bit
/// gradient image; its direction is taken from `smooth`. OpenCV does not tell this number.
double count_drawing_steps(const cv::Mat& smooth, const cv::Mat& magnitude, int threshold,
                           int anchor_threshold);

}  // namespace berth::bench
