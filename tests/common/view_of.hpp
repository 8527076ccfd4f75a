// OpenCV's grey images as the chain sees them.
#pragma once

#include <opencv2/core.hpp>

#include "image/view.hpp"

namespace berth {

/// `image` (CV_8U) must outlive the view.
inline ImageView view_of(const cv::Mat& image) {
  ImageView view;
  view.pixels = image.data;
  view.width = image.cols;
  view.height = image.rows;
  view.stride = static_cast<int>(image.step);
  return view;
}

}  // namespace berth
