#include "app/vision_task.hpp"

namespace berth {

void process_camera_frame(const Parameters& parameters, const hal::CameraFrame& frame,
                          const Prior& prior, Workspace& workspace, FrameResult& result,
                          const StageObserver& observer) {
  ImageView image;  // without a picture its size is zero, which is no camera's
  if (frame.status == hal::FrameStatus::kComplete) {
    image.pixels = frame.pixels.data();
    image.width = frame.width;
    image.height = frame.height;
    image.stride = frame.width;
  }
  process_frame(parameters, image, prior, workspace, result, observer);
}

Span<const std::uint8_t> VisionTask::on_frame(const hal::CameraFrame& frame) {
  process_camera_frame(parameters_, frame, prior_, memory_.workspace, memory_.result, observer_);
  const FrameResult& result = memory_.result;
  const bool is_remembered = parameters_.mode.track && result.identified && result.has_pose;
  prior_ = is_remembered ? Prior{true, result.pose.camera_from_target, result.blur} : Prior{};
  memory_.line.clear();
  reporter_.report(frame, memory_.result, memory_.line);
  return memory_.line.bytes();
}

}  // namespace berth
