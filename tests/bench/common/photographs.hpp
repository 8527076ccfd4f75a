// Crops of real photographs, as they are.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace berth::bench {

struct Photograph {
  std::string path;
  cv::Mat crop;  // its middle, grey, neither scaled nor filtered
};

/// One crop of side x side from each folder below `folder` that holds photographs: of the smallest
/// file that is large enough, since the same picture often comes in many sizes.
std::vector<Photograph> photograph_crops(const std::string& folder, int side);

}  // namespace berth::bench
