// Rigid transforms, poses with covariance, and what the pose stages hand on.
#pragma once

#include <cstdint>

#include "camera/camera.hpp"
#include "core/reason.hpp"
#include "target/model.hpp"

namespace berth {

/// p_a = rotation * p_b + translation for a transform named a_from_b.
struct RigidTransform {
  Mat3Unit rotation = Mat3Unit::Identity();
  Vec3Mm translation_mm = Vec3Mm::Zero();
};

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

/// One located marker, in pixels of the (distorted) image.
enum class MarkerKind : std::uint8_t { kDot = 0, kRing = 1, kLine = 2 };

struct Marker {
  MarkerKind kind = MarkerKind::kDot;
  std::uint8_t index = 0;          // which dot
  bool located = false;            // measured in the image
  bool used = false;               // took part in the final pose
  Vec2Px center_px{Px(0), Px(0)};  // measured area centroid
  Vec2Px bias_px{Px(0), Px(0)};    // centroid of the projected outline minus projected centre
  // Variance of the centroid, px^2, Q<24>: xx, xy, yy.
  Q<24> variance_xx, variance_xy, variance_yy;
};

constexpr int kMaxMarkers = kMaxDots + 2;

struct MarkerSet {
  std::int32_t count = 0;
  Marker markers[kMaxMarkers];  // the dots in the model's order, then the ring, then the line
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
