// See projection.hpp. Formats: rays and their products Q28 and Q27, the radial factor Q28.
#include "camera/projection.hpp"

#include "fixed/roots.hpp"

namespace berth {
namespace {

constexpr int kNewtonSteps = 5;

std::int64_t product(std::int32_t a, std::int32_t b) { return std::int64_t{a} * b; }
std::int32_t product_q(std::int32_t a, std::int32_t b, int shift) {
  return static_cast<std::int32_t>(shift_round(product(a, b), shift));
}

std::int32_t clamp_ray(std::int64_t raw) {
  constexpr std::int32_t limit = kMaxRay.raw();
  return raw > limit ? limit : (raw < -limit ? -limit : static_cast<std::int32_t>(raw));
}

// Quantities shared by the distortion and its Jacobian; |x|, |y| <= 2.
struct Terms {
  std::int32_t x, y;    // Q28
  std::int32_t xx, yy;  // x^2, y^2, Q27, at most 4
  std::int32_t xy2;     // 2 x y, Q27, at most 8
  std::int32_t r2;      // Q27, at most 8
  std::int32_t radial;  // d, Q28, saturated at +-8
};

Terms terms_of(const Camera& camera, const Vec2Ray& ray) {
  Terms t;
  t.x = clamp_ray(ray[0].raw());
  t.y = clamp_ray(ray[1].raw());
  t.xx = product_q(t.x, t.x, 29);
  t.yy = product_q(t.y, t.y, 29);
  t.xy2 = product_q(t.x, t.y, 28);
  t.r2 = t.xx + t.yy;
  // Horner; |k| < 128, r2 <= 8: every sum is below 2^(31 + 4) before it is saturated.
  const std::int32_t c2 =
      saturate32(camera.k2.raw() + shift_round(product(camera.k3.raw(), t.r2), 27));
  const std::int32_t c1 = saturate32(camera.k1.raw() + shift_round(product(c2, t.r2), 27));
  constexpr std::int64_t kOne = std::int64_t{1} << 28;
  t.radial = saturate32(kOne + shift_round(product(c1, t.r2), 23));
  return t;
}

// Distorted ray, Q28, +-8 (saturated).
void distort(const Camera& camera, const Terms& t, std::int32_t& xd, std::int32_t& yd) {
  const std::int32_t p1 = camera.p1.raw(), p2 = camera.p2.raw();
  // Radial parts below 2^62 2^-28, tangential ones below 2^31 2^32 2^-23 = 2^40 with |p| < 128.
  const std::int64_t tx =
      product(p1, t.xy2) + std::int64_t{p2} * (std::int64_t{t.r2} + 2 * std::int64_t{t.xx});
  const std::int64_t ty =
      product(p2, t.xy2) + std::int64_t{p1} * (std::int64_t{t.r2} + 2 * std::int64_t{t.yy});
  xd = saturate32(shift_round(product(t.x, t.radial), 28) + shift_round(tx, 23));
  yd = saturate32(shift_round(product(t.y, t.radial), 28) + shift_round(ty, 23));
}

Px to_pixel(std::int32_t distorted, Px focal, Px center) {
  return Px::saturated(shift_round(product(distorted, focal.raw()), 28) + center.raw());
}

// d(xd, yd) / d(x, y), Q26, symmetric.
struct DistortionJacobian {
  std::int32_t xx, xy, yy;
};

DistortionJacobian jacobian_of(const Camera& camera, const Terms& t) {
  // slope = dd / d(r2) = k1 + 2 k2 r2 + 3 k3 r2^2, Q24.
  const std::int64_t k3 = 3 * std::int64_t{camera.k3.raw()};
  const std::int32_t c2 = saturate32(2 * std::int64_t{camera.k2.raw()} +
                                     shift_round(saturate32(k3) * std::int64_t{t.r2}, 27));
  const std::int32_t slope = saturate32(camera.k1.raw() + shift_round(product(c2, t.r2), 27));
  const std::int32_t p1 = camera.p1.raw(), p2 = camera.p2.raw();
  // p x in Q24 + Q28 -> Q26, |p x| < 2^8.
  const std::int64_t p1x = shift_round(product(p1, t.x), 26),
                     p1y = shift_round(product(p1, t.y), 26);
  const std::int64_t p2x = shift_round(product(p2, t.x), 26),
                     p2y = shift_round(product(p2, t.y), 26);
  const std::int64_t radial = shift_round(t.radial, 2);
  DistortionJacobian j;
  j.xx = saturate32(radial + shift_round(product(slope, t.xx), 24) + 2 * p1y + 6 * p2x);
  j.yy = saturate32(radial + shift_round(product(slope, t.yy), 24) + 6 * p1y + 2 * p2x);
  j.xy = saturate32(shift_round(product(slope, t.xy2), 25) + 2 * p1x + 2 * p2y);
  return j;
}

std::int64_t determinant(const DistortionJacobian& j) {
  return shift_round(product(j.xx, j.yy) - product(j.xy, j.xy), 26);  // Q26
}

Mat2Px pixels_by_ray(const Camera& camera, const DistortionJacobian& j) {
  const auto scaled = [](std::int32_t entry, Px focal) {
    return Px::saturated(shift_round(product(entry, focal.raw()), 26));
  };
  Mat2Px m;
  m << scaled(j.xx, camera.fx), scaled(j.xy, camera.fx),  //
      scaled(j.xy, camera.fy), scaled(j.yy, camera.fy);
  return m;
}

// One Newton step towards the distorted ray (x, y): J step = residual by Cramer's rule.
void newton_step(const Camera& camera, std::int32_t x, std::int32_t y, Vec2Ray& ray) {
  const Terms t = terms_of(camera, ray);
  std::int32_t xd, yd;
  distort(camera, t, xd, yd);
  const DistortionJacobian j = jacobian_of(camera, t);
  const std::int64_t det = determinant(j);
  if (det <= 0) return;  // outside the invertible part of the image
  const std::int32_t rx = clamp_ray(std::int64_t{x} - xd);
  const std::int32_t ry = clamp_ray(std::int64_t{y} - yd);
  // |residual| <= 2^29, |J| <= 2^31 in their raw units: products below 2^60, steps below 2^35.
  const std::int64_t sx = shift_round(product(rx, j.yy) - product(ry, j.xy), 26);
  const std::int64_t sy = shift_round(product(ry, j.xx) - product(rx, j.xy), 26);
  ray[0] = Ray::from_raw(clamp_ray(t.x + sx * (std::int64_t{1} << 26) / det));
  ray[1] = Ray::from_raw(clamp_ray(t.y + sy * (std::int64_t{1} << 26) / det));
}

std::int32_t centered_ray(Px pixel, Px center, Px focal) {
  // (u - c) / f in Q28: |u - c| < 2^16 px, so the shifted numerator is below 2^60.
  const std::int64_t offset = std::int64_t{pixel.raw()} - center.raw();
  const std::int64_t n = offset * (std::int64_t{1} << 28);
  const std::int64_t half = n < 0 ? -(focal.raw() / 2) : focal.raw() / 2;
  return saturate32((n + half) / focal.raw());
}

}  // namespace

Vec2Ray ray_of(const Vec3Mm& point_mm) {
  BERTH_RANGE(point_mm[2].raw() > 0);
  const std::int32_t z = point_mm[2].raw() > 0 ? point_mm[2].raw() : 1;
  const Reciprocal r = reciprocal(static_cast<std::uint32_t>(z));
  return {Ray::from_raw(clamp_ray(multiply_reciprocal(point_mm[0].raw(), r, 28))),
          Ray::from_raw(clamp_ray(multiply_reciprocal(point_mm[1].raw(), r, 28)))};
}

Vec2Px distort_to_pixel(const Camera& camera, const Vec2Ray& ray) {
  std::int32_t xd, yd;
  distort(camera, terms_of(camera, ray), xd, yd);
  return {to_pixel(xd, camera.fx, camera.cx), to_pixel(yd, camera.fy, camera.cy)};
}

Vec2Px project(const Camera& camera, const Vec3Mm& point_mm) {
  return distort_to_pixel(camera, ray_of(point_mm));
}

RayProjection distort_with_jacobian(const Camera& camera, const Vec2Ray& ray) {
  const Terms t = terms_of(camera, ray);
  std::int32_t xd, yd;
  distort(camera, t, xd, yd);
  RayProjection result;
  result.pixel = {to_pixel(xd, camera.fx, camera.cx), to_pixel(yd, camera.fy, camera.cy)};
  result.by_ray = pixels_by_ray(camera, jacobian_of(camera, t));
  return result;
}

bool is_unfolded(const Camera& camera, const Vec2Ray& ray) {
  const DistortionJacobian j = jacobian_of(camera, terms_of(camera, ray));
  return determinant(j) > (std::int64_t{1} << 22);
}

Projection project_with_jacobian(const Camera& camera, const Vec3Mm& point_mm) {
  const Vec2Ray ray = ray_of(point_mm);
  const RayProjection p = distort_with_jacobian(camera, ray);
  const Reciprocal r = reciprocal(static_cast<std::uint32_t>(point_mm[2].raw()));
  Projection result;
  result.pixel = p.pixel;
  result.ray = ray;
  result.by_ray = p.by_ray;
  for (int i = 0; i < 2; ++i) {
    // d/dX = J e_x / Z, d/dY = J e_y / Z, d/dZ = -J (x, y) / Z; px / Q18 mm -> 26 more bits.
    const std::int32_t jx = p.by_ray(i, 0).raw(), jy = p.by_ray(i, 1).raw();
    const std::int32_t jz =
        saturate32(-shift_round(product(jx, ray[0].raw()) + product(jy, ray[1].raw()), 28));
    const std::int32_t by_ray[3] = {jx, jy, jz};
    for (int k = 0; k < 3; ++k) {
      result.by_point(i, k) = PxPerMm::saturated(multiply_reciprocal(by_ray[k], r, 26));
    }
  }
  return result;
}

Vec2Ray undistort_from(const Camera& camera, const Vec2Px& pixel, const Vec2Ray& start) {
  Vec2Ray ray = start;
  newton_step(camera, centered_ray(pixel[0], camera.cx, camera.fx),
              centered_ray(pixel[1], camera.cy, camera.fy), ray);
  return ray;
}

Vec2Ray undistort(const Camera& camera, const Vec2Px& pixel) {
  const std::int32_t x = centered_ray(pixel[0], camera.cx, camera.fx);
  const std::int32_t y = centered_ray(pixel[1], camera.cy, camera.fy);
  Vec2Ray ray{Ray::from_raw(clamp_ray(x)), Ray::from_raw(clamp_ray(y))};
  for (int i = 0; i < kNewtonSteps; ++i) newton_step(camera, x, y, ray);
  return ray;
}

}  // namespace berth
