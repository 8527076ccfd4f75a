// A rigid transform between two frames.
#pragma once

#include "camera/camera.hpp"

namespace berth {

/// p_a = rotation * p_b + translation for a transform named a_from_b.
struct RigidTransform {
  Mat3Unit rotation = Mat3Unit::Identity();
  Vec3Mm translation_mm = Vec3Mm::Zero();
};

}  // namespace berth
