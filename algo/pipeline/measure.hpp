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

/// Refinement of `start` on the image, whose blur is about `blur_mm` on the plate (0: unknown),
/// covariance, tool frame, and whether the pose is valid. Where the refinement does not fit
/// `budget`, the pose of the centroids stands, with Reason::kDeadline.
void refine_from_outlines(const Parameters& parameters, const ImageView& image,
                          const PoseOutcome& start, Mm blur_mm, Workspace& work,
                          FrameResult& result, Work& budget);

}  // namespace berth
