// Grey levels of the frame at places of the target.
#pragma once

#include "camera/projection.hpp"
#include "camera/rigid_transform.hpp"
#include "image/view.hpp"

namespace berth {

using Grey = std::int32_t;  // DN, 4 fraction bits: 0..4080
constexpr Grey kNoGrey = -1;
constexpr int kGreyOne = 16;

/// Bilinear grey level at a pixel position, or kNoGrey outside the image. Cost: about 30.
inline Grey sample(const ImageView& image, const Vec2Px& at) {
  const int x = at[0].floor(), y = at[1].floor();
  if (x < 0 || y < 0 || x + 1 >= image.width || y + 1 >= image.height) return kNoGrey;
  const int fx = (at[0].raw() >> 12) & 15, fy = (at[1].raw() >> 12) & 15;
  const int top = image.at(x, y) * (16 - fx) + image.at(x + 1, y) * fx;
  const int bottom = image.at(x, y + 1) * (16 - fx) + image.at(x + 1, y + 1) * fx;
  return (top * (16 - fy) + bottom * fy) >> 4;
}

/// What is needed to look at target points in a frame.
struct TargetView {
  const Camera& camera;
  const ImageView& image;
  RigidTransform camera_from_target;

  /// Camera coordinates of a target point.
  Vec3Mm to_camera(const Vec3Mm& p) const {
    return camera_from_target.rotation * p + camera_from_target.translation_mm;
  }
  Vec2Px pixel(const Vec3Mm& p) const { return project(camera, to_camera(p)); }
  /// Grey level at (x, y) on the plate's face.
  Grey at(Mm x, Mm y) const { return sample(image, pixel(Vec3Mm(x, y, Mm(0)))); }
};

}  // namespace berth
