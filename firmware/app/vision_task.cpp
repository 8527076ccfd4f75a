#include "app/vision_task.hpp"

namespace berth {

void process_camera_frame(const Parameters& parameters, const hal::CameraFrame& frame,
                          Workspace& workspace, FrameResult& result,
                          const StageObserver& observer) {
  ImageView image;  // without a picture its size is zero, which is no camera's
  if (frame.status == hal::FrameStatus::kComplete) {
    image.pixels = frame.pixels.data();
    image.width = frame.width;
    image.height = frame.height;
    image.stride = frame.width;
  }
  process_frame(parameters, image, workspace, result, observer);
}

Span<const std::uint8_t> VisionTask::on_frame(const hal::CameraFrame& frame) {
  process_camera_frame(parameters_, frame, memory_.workspace, memory_.result, observer_);
  memory_.line.clear();
  reporter_.report(frame, memory_.result, memory_.line);
  return memory_.line.bytes();
}

}  // namespace berth
