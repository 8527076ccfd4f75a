// Instructions per stage of frames that run through the firmware in QEMU: exact counts, not times.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "host_sim/budget/hard_frames.hpp"
#include "pipeline/result.hpp"

namespace berth::host {

struct FrameCount {
  std::string name;
  std::array<double, kStageCount> stages{};
  double frame = 0;  // all stages
  std::uint32_t work_units = 0;
  bool identified = false;
};

struct InstructionCounts {
  std::vector<FrameCount> frames;
  std::uint32_t stack_bytes = 0;
  std::uint32_t stack_peak_bytes = 0;  // painted, over all frames

  /// The value that the share q of the frames lies below; q = 1 is the worst. `value`: of a frame.
  double quantile(double q, const std::function<double(const FrameCount&)>& value) const;
};

/// Runs `frames` through `image` on one emulated board. `on_frame` is told of each. Error: one
/// line.
tl::expected<InstructionCounts, std::string> count_instructions(
    const std::vector<NamedFrame>& frames, const std::vector<std::uint8_t>& parameter_block,
    const std::string& image, const std::function<void()>& on_frame);

}  // namespace berth::host
