// The flight code as one worker of the host simulator runs it: the firmware's vision task, its
// packets decoded. Every worker has a chain, and so a workspace, of its own.
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "host_sim/report/frame_record.hpp"
#include "pipeline/workspace.hpp"

namespace berth::host {

class Chain {
 public:
  /// `parameter_block` has been proven valid by whoever built it; a bad one throws.
  explicit Chain(const std::vector<std::uint8_t>& parameter_block);
  ~Chain();
  Chain(const Chain&) = delete;
  Chain& operator=(const Chain&) = delete;

  /// One frame, without history. An empty image is a frame that could not be read.
  FrameRecord run(const cv::Mat& image, std::size_t index, std::uint32_t period_us);

  /// The stages' intermediate results of the last frame.
  const Workspace& workspace() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace berth::host
