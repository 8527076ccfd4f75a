#include "pipeline/pipeline.hpp"

namespace berth {

const char* stage_name(Stage stage) {
  constexpr const char* kNames[kStageCount] = {"edges",     "link",    "circles", "identify",
                                               "reference", "markers", "pose",    "refine"};
  return stage < Stage::kCount ? kNames[static_cast<int>(stage)] : "unknown";
}

void process_frame(const Parameters& parameters, const ImageView& image, Workspace&,
                   FrameResult& result, const StageObserver& observer) {
  result = FrameResult{};
  if (image.width != parameters.camera.width || image.height != parameters.camera.height) return;
  result.reason = Reason::kNoCircle;
  for (int s = 0; s < kStageCount; ++s) {
    if (observer.on_stage_end) observer.on_stage_end(observer.context, static_cast<Stage>(s));
  }
}

}  // namespace berth
