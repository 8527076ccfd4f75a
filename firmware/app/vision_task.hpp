// The vision task: a camera frame in, packets out. Firmware and host simulator run this same code.
#pragma once

#include <cstdint>

#include "app/frame_reporter.hpp"
#include "hal/camera.hpp"
#include "pipeline/pipeline.hpp"
#include "tmtc/line_writer.hpp"

namespace berth {

/// The chain on a camera frame. A frame that is not complete, or not of the camera's size, gives
/// Reason::kBadFrame. No state: hosts may run it on many frames at a time, each with a workspace
/// and a result of its own.
void process_camera_frame(const Parameters& parameters, const hal::CameraFrame& frame,
                          const Prior& prior, Workspace& workspace, FrameResult& result,
                          const StageObserver& observer = {});

/// What the task works on; all of it belongs to the caller and outlives the task.
struct VisionTaskMemory {
  Workspace& workspace;
  FrameResult& result;  // of the last frame
  LineWriter& line;     // over at least kFrameLineBytes
};

class VisionTask {
 public:
  VisionTask(const Parameters& parameters, VisionTaskMemory memory, StageObserver observer = {})
      : parameters_(parameters), memory_(memory), observer_(observer) {}

  /// Processes one frame and returns what goes on the line for it, valid until the next call.
  Span<const std::uint8_t> on_frame(const hal::CameraFrame& frame);

 private:
  const Parameters& parameters_;
  VisionTaskMemory memory_;
  StageObserver observer_;
  Prior prior_;  // of the last frame, in Mode::track; none after a frame without a pose
  FrameReporter reporter_;
};

}  // namespace berth
