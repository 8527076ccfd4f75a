// The chain of the paper, one call per frame: the only place that knows the order of the stages.
#pragma once

#include <cstdint>

#include "image/view.hpp"
#include "pipeline/parameters.hpp"
#include "pipeline/result.hpp"
#include "pipeline/workspace.hpp"

namespace berth {

/// Told at the end of each stage; for instruction counts and traces, never for results.
struct StageObserver {
  void (*on_stage_end)(void* context, Stage stage) = nullptr;
  void* context = nullptr;
};

/// What is known of the target before the frame is looked at.
struct Prior {
  bool has_pose = false;
  RigidTransform camera_from_target;  // within a few degrees and millimetres
  ImageBlur blur = kUnknownBlur;
};

/// One frame through stages 1 to 6. `image` is read-only and 8 bit; a size that is not the camera's
/// gives Reason::kBadFrame. `workspace` needs no initialisation and afterwards holds the stages'
/// intermediate results for whoever wants to draw them. With a prior the search begins in
/// the target's surroundings; what is not found there is searched in the whole frame. No history
/// beside it: equal inputs, equal bits.
void process_frame(const Parameters& parameters, const ImageView& image, const Prior& prior,
                   Workspace& workspace, FrameResult& result, const StageObserver& observer = {});

}  // namespace berth
