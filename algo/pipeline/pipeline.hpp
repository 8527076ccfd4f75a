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

/// One frame through stages 1 to 6. `image` is read-only and 8 bit; a size that is not the camera's
/// gives Reason::kBadFrame. `workspace` needs no initialisation and afterwards holds the stages'
/// intermediate results for whoever wants to draw them. No history: equal inputs, equal bits.
void process_frame(const Parameters& parameters, const ImageView& image, Workspace& workspace,
                   FrameResult& result, const StageObserver& observer = {});

}  // namespace berth
