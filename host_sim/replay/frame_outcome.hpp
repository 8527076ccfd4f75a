// What a replay knows about one frame: the record from its packets, and how its image was read.
#pragma once

#include <cstddef>
#include <filesystem>
#include <opencv2/core.hpp>
#include <string>

#include "host_sim/replay/image_input.hpp"
#include "host_sim/report/frame_record.hpp"
#include "host_sim/report/reference_comparison.hpp"

namespace berth::host {

struct FrameOutcome {
  std::size_t index = 0;
  std::filesystem::path path;
  FrameRecord record;
  ReferenceComparison reference;  // empty without --reference
  cv::Mat image;                  // as the chain saw it; empty where it could not be read
  Conversions conversions;
  std::string problem;  // why the chain could not see it, with the cure; empty: it could
};

}  // namespace berth::host
