// Bright elliptical regions: contours of adaptive thresholds at several scales.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace berth::host {

/// The ellipse of a region's outer boundary; the region may have holes.
struct Blob {
  cv::RotatedRect ellipse;  ///< full axes in px, OpenCV's angle
  double misfit_px = 0;     ///< rms distance of the boundary from the ellipse

  cv::Point2d center() const { return ellipse.center; }
  double semi_major_px() const { return std::max(ellipse.size.width, ellipse.size.height) / 2; }
  double semi_minor_px() const { return std::min(ellipse.size.width, ellipse.size.height) / 2; }
};

/// Regions whose boundary is an ellipse with an axis ratio of at least 0.4, largest first, each
/// once though several thresholds find it. `gray` is 8 bit with bright markers.
std::vector<Blob> find_blobs(const cv::Mat& gray);

}  // namespace berth::host
