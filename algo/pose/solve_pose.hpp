// Stage 6: from located markers to a pose, or to the reason why there is none.
//
// P3P on several triples, the best distinct candidates and the best one's mirror image (the
// reversal that an affine view of a flat target can't tell apart: R' = (I - 2 v v^T) R diag(1,1,-1)
// with v along the line of sight; Schweighofer, Pinz 2006) refined on all markers, the best kept
// and the best of the clearly different ones beside it. Where the residual is larger than the
// variances allow, each marker in turn is left out; one whose absence makes the rest consistent is
// the wrong one.
#pragma once

#include "core/work.hpp"
#include "pose/refine_centroids.hpp"
#include "pose/select.hpp"

namespace berth {

struct PoseLimits {
  SelectionLimits selection;
  Q<16> residual_sigmas = q<16>(4.0);  // whitened residual of a consistent pose
  Unit ambiguity_ratio = q<30>(0.7);   // best / second-best residual of a unique pose
  Q<16> ambiguity_chi2 = q<16>(16.0);  // second-best minus best chi-square of a unique pose
};

struct PoseOutcome {
  Reason reason = Reason::kNoSolution;
  bool has_pose = false;        // estimate holds a pose, whatever the reason
  PoseEstimate estimate;        // without its covariance
  Q<16> whitened_residual;      // 1: as the variances predict; 0: no redundancy
  std::int32_t candidates = 0;  // P3P poses tried
  std::int32_t iterations = 0;  // Gauss-Newton, all candidates
  std::int32_t left_out = -1;   // place of the marker found wrong in the set, or -1
};

/// Reasons: kNone; kDotMissing (fewer than three located dots); kDegenerate; kNoSolution;
/// kResidualTooLarge and kAmbiguous, both with a pose. `markers`: `used` and `bias_px` are filled,
/// the rest is input. estimate.has_second: a different pose that is a minimum as well; ambiguity
/// tells how good. Cost: below 3 M instructions; 5 KiB of stack. A `guess` at the pose to some per
/// cent saves the triples where the dots agree beside it: a half of the cost, as a rule.
/// Where `work` is spent on the way, with what was refined so far: not to be relied upon.
PoseOutcome solve_pose(const Camera& camera, const TargetModel& target, MarkerSet& markers,
                       const PoseLimits& limits, Work& work, const RigidTransform* guess = nullptr);

/// Fills the covariance of an estimate of solve_pose(), from the centroids' variances and with the
/// markers it used: apart, as the outlines bring one of their own as a rule. False where the
/// markers leave a direction undetermined. Cost: about 60 k instructions for five dots.
bool find_covariance(const Camera& camera, const TargetModel& target, const MarkerSet& markers,
                     PoseEstimate& estimate);

}  // namespace berth
