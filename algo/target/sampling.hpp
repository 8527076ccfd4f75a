// Grey levels of the frame at places of the target.
#pragma once

#include "camera/projection.hpp"
#include "camera/rigid_transform.hpp"
#include "image/view.hpp"

namespace berth {

using Grey = std::int32_t;  // DN, 4 fraction bits: 0..4080
constexpr Grey kNoGrey = -1;
constexpr int kGreyOne = 16;

/// Bilinear grey level at a pixel position, or kNoGrey outside the image. Cost: about 25.
inline Grey sample(const ImageView& image, const Vec2Px& at) {
  const int x = at[0].floor(), y = at[1].floor();
  // One comparison each: what is negative is large without its sign.
  if (static_cast<unsigned>(x) >= static_cast<unsigned>(image.width - 1)) return kNoGrey;
  if (static_cast<unsigned>(y) >= static_cast<unsigned>(image.height - 1)) return kNoGrey;
  const int fx = (at[0].raw() >> 12) & 15, fy = (at[1].raw() >> 12) & 15;
  const std::uint8_t* const top_row = image.row(y) + x;
  const std::uint8_t* const bottom_row = top_row + image.stride;
  const int top = 16 * top_row[0] + fx * (top_row[1] - top_row[0]);
  const int bottom = 16 * bottom_row[0] + fx * (bottom_row[1] - bottom_row[0]);
  const int level = 16 * top + fy * (bottom - top);
  // The weights sum up to 256: the complement of all is that of the sum.
  return (image.polarity_mask != 0 ? 255 * 256 - level : level) >> 4;
}

/// What is needed to look at target points in a frame.
struct TargetView {
  const Camera& camera;
  const ImageView& image;
  RigidTransform camera_from_target;

  /// Pixel of a target point, |coordinates| < 2048 mm. Cost: about 160.
  Vec2Px pixel(const Vec3Mm& p) const;
  /// Pixel of a point on the plate's face.
  Vec2Px pixel(Mm x, Mm y) const;
  /// Grey level at (x, y) on the plate's face. Cost: about 190.
  Grey at(Mm x, Mm y) const { return sample(image, pixel(x, y)); }
};

}  // namespace berth
