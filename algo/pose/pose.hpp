// Poses with covariance, and what the pose stages hand on.
#pragma once

#include <cstdint>

#include "camera/camera.hpp"
#include "camera/rigid_transform.hpp"
#include "core/reason.hpp"
#include "marker/marker.hpp"
#include "target/model.hpp"

namespace berth {

/// Hamilton unit quaternion w x y z, w >= 0.
struct Quaternion {
  Unit w = Unit(1), x, y, z;
};

/// Covariance of (delta, dt): R_est = exp(delta) R_true with delta in the axes of the first-named
/// frame (rad), dt = t_est - t_true in that frame (mm). Order: rx ry rz tx ty tz.
struct PoseCovariance {
  Angle sigma_rotation[3];     // rad
  Mm sigma_translation_mm[3];  // mm
  Unit correlation[15];        // upper triangle by rows: 01 02 03 04 05 12 13 ... 45
};

/// A pose with what is known about it.
struct PoseEstimate {
  RigidTransform camera_from_target;
  PoseCovariance covariance;
  Px residual_px;  // root mean square of the whitened-back residuals, pixels
  std::int32_t markers_used = 0;
  bool has_second = false;  // another pose fits almost as well
  RigidTransform second;    // that pose
  Px second_residual_px;
  Unit ambiguity;  // best residual / second-best residual, 0..1; 0: no second pose
};

}  // namespace berth
