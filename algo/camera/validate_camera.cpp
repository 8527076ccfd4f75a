// See validate_camera.hpp.
#include "camera/validate_camera.hpp"

#include "camera/projection.hpp"

namespace berth {
namespace {

constexpr std::int32_t kMaxSide = 1024;
constexpr Px kMinFocal = Px(16);
constexpr Px kMaxFocal = Px(4096);
constexpr std::int64_t kResidual = 4;  // 2^-14 px
constexpr int kGrid = 32;
constexpr std::int32_t kStep = 65536 / kGrid;  // of the grid, Px per pixel of side; product < 2^27

bool is_focal_length(Px f) { return f >= kMinFocal && f <= kMaxFocal; }

Px half(Px f) { return f * q<16>(0.5); }

bool is_center(Px c, std::int32_t side) { return c >= Px(-side) && c <= Px(2 * side); }

constexpr Coefficient kMaxTangential = q<24>(0.5);

bool is_small(Coefficient p) { return p < kMaxTangential && p > -kMaxTangential; }

bool is_near(Px a, Px b) {
  const std::int64_t difference = std::int64_t{a.raw()} - b.raw();
  return difference <= kResidual && difference >= -kResidual;
}

// The pixel's ray exists, returns to the pixel, and its neighbourhood is not folded.
bool is_invertible_at(const Camera& camera, const Vec2Px& pixel) {
  const Vec2Ray ray = undistort(camera, pixel);
  if (abs(ray[0]) >= kMaxRay || abs(ray[1]) >= kMaxRay) return false;
  const Vec2Px back = distort_to_pixel(camera, ray);
  if (!is_near(back[0], pixel[0]) || !is_near(back[1], pixel[1])) return false;
  return is_unfolded(camera, ray);
}

bool is_invertible(const Camera& camera) {
  for (int i = 0; i <= kGrid; ++i) {
    for (int j = 0; j <= kGrid; ++j) {
      // From edge to edge of the image: half a pixel beyond the centres of its border pixels.
      const std::int32_t u = camera.width * j * kStep - 32768;
      const std::int32_t v = camera.height * i * kStep - 32768;
      if (!is_invertible_at(camera, {Px::from_raw(u), Px::from_raw(v)})) return false;
    }
  }
  return true;
}

}  // namespace

FieldFault validate_camera(const Camera& camera) {
  if (camera.width < 1 || camera.width > kMaxSide) return {"camera.width"};
  if (camera.height < 1 || camera.height > kMaxSide) return {"camera.height"};
  if (!is_focal_length(camera.fx)) return {"camera.fx"};
  if (!is_focal_length(camera.fy)) return {"camera.fy"};
  if (camera.fy < half(camera.fx) || camera.fx < half(camera.fy)) return {"camera.fy"};
  if (!is_center(camera.cx, camera.width)) return {"camera.cx"};
  if (!is_center(camera.cy, camera.height)) return {"camera.cy"};
  if (!is_small(camera.p1)) return {"camera.p1"};
  if (!is_small(camera.p2)) return {"camera.p2"};
  return is_invertible(camera) ? FieldFault{} : FieldFault{"camera.distortion"};
}

}  // namespace berth
