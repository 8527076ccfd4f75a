// A frame with everything that was found in it drawn on top, to be judged by eye.
//
// Chains in changing colours, candidate ellipses yellow, the accepted ring magenta; markers as
// crosses, green where they took part in the pose, red where not; outlines of all markers as the
// pose predicts them in cyan; axes x red, y green, z blue. A small target is shown magnified in a
// corner as well. Text and magnifier keep off the target.
#pragma once

#include <opencv2/core.hpp>

#include "host_sim/io/camera_model.hpp"
#include "host_sim/io/target_file.hpp"
#include "host_sim/report/frame_record.hpp"
#include "host_sim/report/trace.hpp"

namespace berth::host {

struct OverlayScene {
  const Camera& camera;
  const Target& target;
};

/// `image` is what the chain saw, 8 bit; empty or of a wrong size is drawn as it is. `trace` is
/// null where only the packets are known (runs on target). Returns an 8-bit colour picture.
cv::Mat draw_overlay(const cv::Mat& image, const FrameRecord& record, const Trace* trace,
                     const OverlayScene& scene);

}  // namespace berth::host
