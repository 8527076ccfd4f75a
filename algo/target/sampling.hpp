// Grey levels of the frame at places of the target.
#pragma once

#include "camera/projection.hpp"
#include "camera/rigid_transform.hpp"
#include "image/view.hpp"

namespace berth {

using Grey = std::int32_t;  // DN, 4 fraction bits: 0..4080
constexpr Grey kNoGrey = -1;
constexpr int kGreyOne = 16;

/// Bilinear grey level between a pixel and those right of and below it, fx and fy sixteenths on.
inline Grey sample_inside(const ImageView& image, int x, int y, int fx, int fy) {
  BERTH_RANGE(x >= 0 && x < image.width - 1 && y >= 0 && y < image.height - 1);
  const std::uint8_t* const top_row = image.row(y) + x;
  const std::uint8_t* const bottom_row = top_row + image.stride;
  const int top = 16 * top_row[0] + fx * (top_row[1] - top_row[0]);
  const int bottom = 16 * bottom_row[0] + fx * (bottom_row[1] - bottom_row[0]);
  const int level = 16 * top + fy * (bottom - top);
  // The weights sum up to 256: the complement of all is that of the sum.
  return (image.polarity_mask != 0 ? 255 * 256 - level : level) >> 4;
}

/// The same at any pixel position, or kNoGrey outside the image. Cost: about 25.
inline Grey sample(const ImageView& image, const Vec2Px& at) {
  const int x = at[0].floor(), y = at[1].floor();
  // One comparison each: what is negative is large without its sign.
  if (static_cast<unsigned>(x) >= static_cast<unsigned>(image.width - 1)) return kNoGrey;
  if (static_cast<unsigned>(y) >= static_cast<unsigned>(image.height - 1)) return kNoGrey;
  return sample_inside(image, x, y, at[0].raw() >> 12 & 15, at[1].raw() >> 12 & 15);
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

/// Where a straight way over the plate's face is in the image, to second order: three projections
/// for all of its samples. A way of 256 leads to (x + dx, y + dy).
class Scan {
 public:
  static constexpr int kStep = 16;  // from sample to sample

  /// About (x, y), read up to `longest` (at most 255) to both sides.
  Scan(const TargetView& view, Mm x, Mm y, Mm dx, Mm dy, int longest);

  /// Does all of it lie in the image? Only then it may be read.
  bool is_inside() const { return is_inside_; }
  /// The same way `by` beside this one.
  Scan moved(const ImageView& image, const Vec2Px& by) const;
  Vec2Px middle() const { return Vec2Px(Px::from_raw(x_.middle), Px::from_raw(y_.middle)); }
  /// `count` levels from `way` on. Cost: about 40 each.
  void read(const ImageView& image, int way, int count, Grey* level) const;

 private:
  // middle + (first way + second way^2 / 256) / 2, middle in 1/65536 px: |first| <= 2^20, |second|
  // <= 2^15, so that 2^19 px lie between any two places of the image.
  struct Axis {
    std::int32_t middle, first, second;
    bool is_inside(int longest, int size) const;
  };
  void look_for_borders(const ImageView& image);

  Axis x_, y_;
  int longest_;
  bool is_inside_ = false;
};

}  // namespace berth
