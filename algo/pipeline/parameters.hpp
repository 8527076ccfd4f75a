// Everything the chain needs to know about its surroundings: the decoded parameter block.
#pragma once

#include "camera/camera.hpp"
#include "pose/pose.hpp"
#include "target/model.hpp"

namespace berth {

/// Limits of the decisions; the defaults are what docs/interfaces.md explains.
struct Thresholds {
  // A valid pose has three sigma below the limits of a false pose.
  Angle false_rotation = q<28>(0.034906585);  // 2 deg
  Q<24> false_translation = q<24>(0.02);      // of the distance
  // Two poses are ambiguous when best / second-best residual exceeds this.
  Unit ambiguity_ratio = q<30>(0.7);
  // A pose is refused when its whitened residual (1 = as the noise predicts) exceeds this.
  Q<16> residual_sigmas = q<16>(4.0);
  // Edges must stand out of the measured noise by this factor.
  Q<16> edge_sigmas = q<16>(4.5);
  // Work of a frame, in thousands of instructions: until the target is found, and in all
  // (docs/deadline.md).
  std::int32_t search_budget_units = 18000;
  std::int32_t frame_budget_units = 26000;
};

/// How the chain is run.
struct Mode {
  bool track = false;  // begin each frame's search where the last one found the target
};

struct Parameters {
  Camera camera;
  TargetModel target;
  RigidTransform effector_from_camera;  // T_EC, hand-eye calibration
  RigidTransform target_from_latch;     // T_TL, mounting of the target on the payload
  Thresholds thresholds;
  Mode mode;
};

}  // namespace berth
