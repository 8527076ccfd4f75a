// Where a marker's area centroid must appear: perspective and lens distortion over its whole area.
//
//   c = sum_k w_k J_k u(X_k) / sum_k w_k J_k,  J = |d(pixel area) / d(target area)|
//
// The image of a marker's centre is not the centroid of its image: the near half is magnified more
// (0.3 px for a dot, 6 px for the ring at 300 mm and 40 deg), and distortion adds its own share.
// Both are in the integral of u J over the marker's area, evaluated by a cubature over few nodes:
// a circle of n equally spaced nodes at the root mean square radius is exact to degree 3 for a disc
// (n = 4) and, but for 1.6 % of the degree 4 term, to degree 5 for the ring (n = 8); the bar has
// 3 x 2 Gauss nodes (Abramowitz and Stegun 25.4.30). Perspective: J ~ Z^-3; distortion: det du/dx.
// Error against the dense outline: see docs/pose.md.
#pragma once

#include <cstdint>

#include "camera/projection.hpp"
#include "pose/pose.hpp"

namespace berth {

constexpr int kMaxNodes = 8;

/// A marker's cubature, in the target frame.
struct MarkerNodes {
  std::int32_t count = 0;
  Vec3Mm center_mm{Mm(0), Mm(0), Mm(0)};
  Vec3Mm point_mm[kMaxNodes];
  Unit weight[kMaxNodes];  // sum is 1
};

/// Nodes of the marker `kind`, `index` (of a dot). Precondition: the model has it.
MarkerNodes nodes_of(const TargetModel& target, MarkerKind kind, int index);

/// A rotated point and its camera coordinates. False, and not to be used, where the point is nearer
/// to the camera's plane than 1 mm or out of range of Mm.
bool transform_point(const RigidTransform& camera_from_target, const Vec3Mm& point_mm,
                     Vec3Mm& rotated_mm, Vec3Mm& camera_mm);

/// d(u, v) / d(delta, dt), delta in rad with 12 fraction bits, dt in units of 256 mm with 12.
/// |entries| < 2^28 (saturated).
struct PoseJacobian {
  static constexpr int kFraction = 12;
  static constexpr int kUnitBits = 8;  // dt in units of 2^8 mm
  std::int32_t row[2][6];
};

struct PredictedCentroid {
  Vec2Px centroid_px;
  PoseJacobian by_pose;  // of the projected centre: the centroid's to (size / distance)^2
};

/// Predicts the area centroid. False when a node is not in front of the camera.
/// Cost: about 700 instructions per node and 1000.
bool predict_centroid(const Camera& camera, const RigidTransform& camera_from_target,
                      const MarkerNodes& nodes, PredictedCentroid& out);

/// The same without derivatives.
bool predict_centroid(const Camera& camera, const RigidTransform& camera_from_target,
                      const MarkerNodes& nodes, Vec2Px& centroid_px);

/// The same with the perspective part of J_k only: for comparing
/// candidates (the distortion's part is below 0.03 px for a dot). Cost: about 220 per node.
bool predict_centroid_roughly(const Camera& camera, const RigidTransform& camera_from_target,
                              const MarkerNodes& nodes, Vec2Px& centroid_px);

/// Projected centre of a marker; false as above.
bool project_center(const Camera& camera, const RigidTransform& camera_from_target,
                    const MarkerNodes& nodes, Vec2Px& center_px);

}  // namespace berth
