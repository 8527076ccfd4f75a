// What an edge detector delivers, in a form in which all detectors can be measured alike.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace berth::bench {

/// One chain: the pixels of the detector's grid it runs over, and the places in the frame it
/// stands for (the pixels' centres, or sub-pixel where the detector has them).
struct PixelChain {
  std::vector<cv::Point> pixels;
  std::vector<cv::Point2d> places_px;
};

struct Detection {
  std::vector<PixelChain> chains;
  cv::Size grid;     // in which the pixels lie
  int bin = 1;       // frame pixels per pixel of the grid
  double steps = 0;  // how often a walk stood on a pixel and looked for the next; 0: not known
  double time_ms = 0;
};

/// Frame coordinates of the centre of pixel `p` of a grid binned by `bin`.
inline cv::Point2d centre_of(cv::Point p, int bin) {
  return {bin * p.x + 0.5 * (bin - 1), bin * p.y + 0.5 * (bin - 1)};
}

}  // namespace berth::bench
