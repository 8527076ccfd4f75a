// Stage 6 in order: pose from the dots, refinement on the outlines, verdict, tool frame.
#pragma once

#include "core/work.hpp"
#include "pipeline/parameters.hpp"
#include "pipeline/result.hpp"
#include "pipeline/workspace.hpp"
#include "pose/solve_pose.hpp"

namespace berth {

/// Pose from result.markers, not far from `guess`; marks the markers used.
PoseOutcome solve_from_dots(const Parameters& parameters, const RigidTransform& guess,
                            FrameResult& result, Work& budget);

/// Of the image, before the outlines are looked at.
struct StartBlur {
  Mm sigma_mm{0};  // on the plate, as the dots show it; 0: unknown
  ImageBlur last;  // of the frame before, or kUnknownBlur
};

/// Refinement of `start` on the image, covariance, tool frame, and whether the pose is valid. Where
/// the refinement does not fit `budget`, the pose of the centroids stands, with Reason::kDeadline.
void refine_from_outlines(const Parameters& parameters, const ImageView& image,
                          const PoseOutcome& start, const StartBlur& blur, Workspace& work,
                          FrameResult& result, Work& budget);

}  // namespace berth
