// Blur of the image measured on the outlines, as a covariance matrix S.
//
// Across an edge with normal n the variance is v = n^T S n. dI/dv = -C p(x) x / (2 v) is odd about
// the edge where dI/d(displacement) is even, so S and the pose are estimated side by side. What of
// S is common to all directions is defocus and pixel area, the rest is straight motion.
#pragma once

#include <cstdint>

#include "pose/outline_normal.hpp"

namespace berth {

/// Normal equations in (xx, xy, yy): matrix Q<28>, vector Q<30>, DN^2 / px^4.
struct BlurNormal {
  std::int64_t matrix[3][3];  // lower triangle
  std::int64_t vector[3];
};

/// What the grey levels of a sector share with the blur, Q<22>.
struct BlurShare {
  std::int64_t by_black[3], by_contrast[3];
};

/// Sums of one sector.
struct SectorBlur : BlurShare {
  BlurNormal normal;
};

/// `contrast` DN Q<4>.
void add_blur(const SegmentSums& segment, const OutlineMiddle& middle, std::int32_t contrast,
              SectorBlur& sector);

/// Adds a sector with its levels eliminated, as add_sector() does for the pose.
void add_sector_blur(const SectorBlur& blur, const LevelBasis& basis, BlurNormal& normal);

/// By how much a step changed the blur: less than a quarter of the trace hardly moves the pose; of
/// less than a tenth in any direction outliers take no notice either.
struct BlurChange {
  bool is_small, is_slight;
};

/// One Gauss-Newton step, limited to a factor of 3 of the trace and a quarter of the smaller
/// eigenvalue; eigenvalues kept in 0.2 to 9 px^2.
/// Half a step where it swings back from the last one, by which the trace had a `growth` (0: none
/// yet): where white is clipped, edge offset and blur pull at each other.
BlurChange update_blur(const BlurNormal& normal, std::int64_t& growth, ImageBlur& blur);

/// The same in all directions, `variance` px^2 Q<16>, within these limits.
ImageBlur round_blur(std::int64_t variance);

/// Smaller eigenvalue.
Q<16> blur_floor(const ImageBlur& blur);

}  // namespace berth
