// See projection.hpp. Formats: rays and their products Q28 and Q27, the radial factor Q28.
#include "camera/projection.hpp"

namespace berth {
namespace {

constexpr int kNewtonSteps = 4;

// saturate32 whose result GCC 12 takes for the 32-bit number it is: without the barrier it carries
// the sign extension along and multiplies with three instructions more on the Arm target.
inline std::int32_t clamp32(std::int64_t value) {
  std::int32_t result = saturate32(value);
#if defined(__arm__)
  asm("" : "+r"(result));
#endif
  return result;
}

inline std::int64_t product(std::int32_t a, std::int32_t b) { return std::int64_t{a} * b; }
std::int32_t product_q(std::int32_t a, std::int32_t b, int shift) {
  return static_cast<std::int32_t>(shift_round(product(a, b), shift));
}

// Upper half of a product: 32 fraction bits fewer, rounded down. One instruction.
inline std::int32_t upper(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(product(a, b) >> 32);
}

template <typename Number>
inline std::int32_t clamp_ray(Number raw) {
  constexpr std::int32_t limit = kMaxRay.raw();
  return raw > limit ? limit : (raw < -limit ? -limit : static_cast<std::int32_t>(raw));
}

// Quantities shared by the distortion and its Jacobian; |x|, |y| <= 2.
struct Terms {
  std::int32_t x, y;    // Q28
  std::int32_t xx, yy;  // x^2, y^2, Q28, below 4
  std::int32_t xy2;     // 2 x y, Q28, below 8
  std::int32_t r2;      // Q28, below 8
  std::int32_t radial;  // d, Q28, saturated at +-8
  std::int32_t p1, p2;  // Q28, clamped to +-1/2, where valid cameras stay
  bool is_mild;         // nothing below can saturate
};

// a + b r2, a and b in one format, r2 in Q28.
inline std::int64_t horner(std::int64_t a, std::int32_t b, std::int32_t r2) {
  return a + shift_round(product(b, r2), 28);
}

inline bool fits32(std::int64_t value) { return value == static_cast<std::int32_t>(value); }

// (k1 + k2 r2 + k3 r2^2) r2 in Q28. Coefficients below 8, as wide lenses with r2 near 1 have them,
// are kept to 28 bits. Larger ones go with the small r2 of long lenses: there 22 bits do, and what
// exceeds 512 saturates.
std::int64_t radial_part(const Camera& camera, std::int32_t r2) {
  const std::int32_t k1 = camera.k1.raw(), k2 = camera.k2.raw(), k3 = camera.k3.raw();
  constexpr std::uint32_t kEight = std::uint32_t{1} << 27;  // Q24
  if (k1 + kEight < 2 * kEight && k2 + kEight < 2 * kEight && k3 + kEight < 2 * kEight) {
    const std::int64_t inner = horner(16 * k2, 16 * k3, r2);
    if (fits32(inner)) {
      const std::int64_t sum = horner(16 * k1, static_cast<std::int32_t>(inner), r2);
      if (fits32(sum)) return shift_round(product(static_cast<std::int32_t>(sum), r2), 28);
    }
  }
  const std::int32_t inner = clamp32(horner(k2 >> 2, k3 >> 2, r2));
  return shift_round(product(clamp32(horner(k1 >> 2, inner, r2)), r2), 22);
}

// r2 below 1/2 and radial coefficients within +-4, tangential ones within +-1/2, as almost all rays
// and cameras have them: every sum below stays within 7, |d| below 4.5, the distorted ray within
// 4.5, entries of its Jacobian within 20. One comparison for each bound.
inline bool is_mild(const Camera& camera, std::int32_t r2) {
  constexpr std::uint32_t kFour = std::uint32_t{1} << 26, kHalf = std::uint32_t{1} << 23;  // Q24
  const auto raised = [](Coefficient k, std::uint32_t by) {
    return static_cast<std::uint32_t>(k.raw()) + by;
  };
  const std::uint32_t radial =
      raised(camera.k1, kFour) | raised(camera.k2, kFour) | raised(camera.k3, kFour);
  const std::uint32_t tangential = raised(camera.p1, kHalf) | raised(camera.p2, kHalf);
  return (radial | static_cast<std::uint32_t>(r2)) < 2 * kFour && tangential < 2 * kHalf;
}

// d there: the sums of radial_part(), each rounded product the upper half of one.
inline std::int32_t mild_radial(const Camera& camera, std::int32_t r2) {
  const std::int32_t r2_q32 = 16 * r2;
  const std::int32_t inner = 16 * camera.k2.raw() + multiply_high(16 * camera.k3.raw(), r2_q32);
  const std::int32_t sum = 16 * camera.k1.raw() + multiply_high(inner, r2_q32);
  return (1 << 28) + multiply_high(sum, r2_q32);
}

std::int32_t tangential(Coefficient p) {
  constexpr std::int32_t kHalf = 1 << 23;
  return 16 * (p.raw() > kHalf ? kHalf : (p.raw() < -kHalf ? -kHalf : p.raw()));
}

// What of them is not mild.
[[gnu::noinline]] void fill_far(const Camera& camera, Terms& t) {
  t.xy2 = product_q(t.x, t.y, 27);
  t.radial = clamp32((1 << 28) + radial_part(camera, t.r2));
  t.p1 = tangential(camera.p1);
  t.p2 = tangential(camera.p2);
}

inline Terms terms_of(const Camera& camera, const Vec2Ray& ray) {
  Terms t;
  t.x = clamp_ray(ray[0].raw());
  t.y = clamp_ray(ray[1].raw());
  t.xx = multiply_high(4 * t.x, 4 * t.x);
  t.yy = multiply_high(4 * t.y, 4 * t.y);
  t.r2 = t.xx + t.yy;
  t.is_mild = is_mild(camera, t.r2);
  if (t.is_mild) {
    t.xy2 = multiply_high(8 * t.x, 4 * t.y);  // |x|, |y| < 0.71
    t.radial = mild_radial(camera, t.r2);
    t.p1 = 16 * camera.p1.raw();
    t.p2 = 16 * camera.p2.raw();
  } else {
    fill_far(camera, t);
  }
  return t;
}

struct Distorted {
  std::int32_t x, y;  // Q28, saturated at +-8
};

[[gnu::noinline]] Distorted distort_far(const Terms& t) {
  const std::int64_t x =
      product(t.x, t.radial) + product(t.p1, t.xy2) + product(t.p2, t.r2) + 2 * product(t.p2, t.xx);
  const std::int64_t y =
      product(t.y, t.radial) + product(t.p2, t.xy2) + product(t.p1, t.r2) + 2 * product(t.p1, t.yy);
  return {clamp32(shift_round(x, 28)), clamp32(shift_round(y, 28))};
}

// One chain of multiply-accumulates per coordinate, with 56 fraction bits: below 2^60 for the
// radial part, 2^58 and 2^59 for the tangential ones.
inline Distorted distort(const Terms& t) {
  if (t.is_mild) {
    const std::int64_t x =
        product(t.x, t.radial) + product(t.p1, t.xy2) + product(t.p2, t.r2 + 2 * t.xx);
    const std::int64_t y =
        product(t.y, t.radial) + product(t.p2, t.xy2) + product(t.p1, t.r2 + 2 * t.yy);
    return {static_cast<std::int32_t>(shift_round(x, 28)),
            static_cast<std::int32_t>(shift_round(y, 28))};
  }
  return distort_far(t);
}

// The product is below 2^59: with a focal length of less than 2048 px it is the upper half of one.
inline Px to_pixel(std::int32_t distorted, Px focal, Px center) {
  if (focal.raw() >= 0 && focal.raw() < (1 << 27)) {
    const std::int32_t offset = multiply_high(distorted, 16 * focal.raw());  // below 2^30
    std::int32_t pixel;
    if (!__builtin_add_overflow(offset, center.raw(), &pixel)) return Px::from_raw(pixel);
  }
  return Px::saturated(shift_round(product(distorted, focal.raw()), 28) + center.raw());
}

// d(xd, yd) / d(x, y), Q26, symmetric.
struct DistortionJacobian {
  std::int32_t xx, xy, yy;
};

// Good to 2^-16 (1 + r2)^2: Newton steps and normal equations need no more.
inline DistortionJacobian jacobian_of(const Camera& camera, const Terms& t) {
  // slope = dd / d(r2) = k1 + 2 k2 r2 + 3 k3 r2^2, Q18. |inner| < 256 + 384 8 fits without care.
  const std::int32_t k3x3 = 3 * (camera.k3.raw() >> 2);  // Q22
  const std::int32_t inner = (camera.k2.raw() >> 5) + upper(k3x3, t.r2);
  const std::int64_t wide_slope = (camera.k1.raw() >> 6) + (product(inner, t.r2) >> 28);
  const std::int32_t slope =
      t.is_mild ? static_cast<std::int32_t>(wide_slope) : clamp32(wide_slope);
  // Tangential parts 2 (p1 y + 3 p2 x), 2 (3 p1 y + p2 x), 2 (p1 x + p2 y) from Q24 products.
  const std::int32_t p1x = upper(t.p1, t.x), p1y = upper(t.p1, t.y);
  const std::int32_t p2x = upper(t.p2, t.x), p2y = upper(t.p2, t.y);
  const std::int32_t radial = t.radial >> 2;
  DistortionJacobian j;
  const auto entry = [&t](std::int64_t curved, std::int32_t rest) {
    return t.is_mild ? static_cast<std::int32_t>(curved) + rest : clamp32(curved + rest);
  };
  j.xx = entry(product(slope, t.xx) >> 19, radial + 8 * (p1y + 3 * p2x));
  j.yy = entry(product(slope, t.yy) >> 19, radial + 8 * (3 * p1y + p2x));
  j.xy = entry(product(slope, t.xy2) >> 20, 8 * (p1x + p2y));
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
  const Distorted d = distort(t);
  const DistortionJacobian j = jacobian_of(camera, t);
  const std::int64_t det = determinant(j);
  if (det <= 0) return;  // outside the invertible part of the image
  const std::int32_t rx = clamp_ray(std::int64_t{x} - d.x);
  const std::int32_t ry = clamp_ray(std::int64_t{y} - d.y);
  // |residual| <= 2^29, |J| <= 2^31 in their raw units: products below 2^60.
  const std::int32_t ax = clamp32(shift_round(product(rx, j.yy) - product(ry, j.xy), 26));
  const std::int32_t ay = clamp32(shift_round(product(ry, j.xx) - product(rx, j.xy), 26));
  const Reciprocal r = reciprocal(static_cast<std::uint32_t>(det < UINT32_MAX ? det : UINT32_MAX));
  ray[0] = Ray::from_raw(clamp_ray(t.x + multiply_reciprocal(ax, r, 26)));
  ray[1] = Ray::from_raw(clamp_ray(t.y + multiply_reciprocal(ay, r, 26)));
}

std::int32_t positive_depth(Mm z) {
  BERTH_RANGE(z.raw() > 0);
  return z.raw() > 0 ? z.raw() : 1;
}

// value / z of raw numbers as the upper half of one product: with both shifted left by r.shift,
// value 2^(30 - headroom) / z = (value 2^(shift - headroom)) mantissa 2^-32.
// |value| < 2^(headroom - 1) z, so that the shifted value fits 32 bits.
inline std::int32_t quotient(std::int32_t value, Reciprocal r, int headroom) {
  const int left = r.shift - headroom;
  const std::int32_t shifted =
      left >= 0 ? static_cast<std::int32_t>(static_cast<std::uint32_t>(value) << left)
                : value >> -left;
  return multiply_high(shifted, r.mantissa);
}

// value / z in Q28, clamped to kMaxRay. Depths from 4096 mm on give up one bit of the value.
inline Ray ray_component(std::int32_t value, std::int32_t z, Reciprocal r) {
  if (z >= (1 << 30)) return Ray::from_raw(clamp_ray(quotient(value, r, 2)));
  const std::int32_t limit = 2 * z;
  if (value > limit) value = limit;
  if (value < -limit) value = -limit;
  const auto shifted =
      static_cast<std::int32_t>(static_cast<std::uint32_t>(value) << (r.shift - 2));
  return Ray::from_raw(clamp_ray(multiply_high(shifted, r.mantissa)));
}

// value px / z mm in Q24. Below 32 px/mm the short quotient serves, to 2^-24 of the value.
PxPerMm per_mm(std::int32_t value, std::int32_t z, Reciprocal r) {
  const bool is_short = z >= (1 << 28) || (value <= 8 * z && value >= -8 * z);
  if (is_short) return PxPerMm::from_raw(quotient(value, r, 4));
  return PxPerMm::saturated(multiply_reciprocal(value, r, 26));
}

// (u - c) / f in Q28, saturated at +-8. 2^20 <= raw f < 2^29.
std::int32_t centered_ray(Px pixel, Px center, Px focal) {
  const std::int32_t offset = clamp32(std::int64_t{pixel.raw()} - center.raw());
  const Reciprocal r = reciprocal(static_cast<std::uint32_t>(focal.raw()));
  return clamp32(multiply_reciprocal(offset, r, 28));
}

// project() of a point within 45 degrees where everything is mild and the pixel in range: most of
// the work of stages 3 to 5, in one piece and without a clamp.
inline bool project_mildly(const Camera& camera, const Vec3Mm& point_mm, Vec2Px& pixel) {
  const auto z = static_cast<std::uint32_t>(point_mm[2].raw());
  const auto left = static_cast<std::uint32_t>(point_mm[0].raw());
  const auto up = static_cast<std::uint32_t>(point_mm[1].raw());
  if (z - 1 >= (1u << 30) - 1 || left + z >= 2 * z || up + z >= 2 * z) return false;
  // ray_component()
  const Reciprocal r = reciprocal(z);
  const std::int32_t x =
      multiply_high(static_cast<std::int32_t>(left << (r.shift - 2)), r.mantissa);
  const std::int32_t y = multiply_high(static_cast<std::int32_t>(up << (r.shift - 2)), r.mantissa);
  const std::int32_t xx = multiply_high(4 * x, 4 * x), yy = multiply_high(4 * y, 4 * y);
  const std::int32_t r2 = xx + yy;
  constexpr std::uint32_t kLongFocus = std::uint32_t{1} << 27;  // to_pixel()
  const auto fx = static_cast<std::uint32_t>(camera.fx.raw());
  const auto fy = static_cast<std::uint32_t>(camera.fy.raw());
  if (!is_mild(camera, r2) || (fx | fy) >= kLongFocus) return false;
  const std::int32_t xy2 = multiply_high(8 * x, 4 * y), radial = mild_radial(camera, r2);
  const std::int32_t p1 = 16 * camera.p1.raw(), p2 = 16 * camera.p2.raw();
  const std::int64_t u = product(x, radial) + product(p1, xy2) + product(p2, r2 + 2 * xx);
  const std::int64_t v = product(y, radial) + product(p2, xy2) + product(p1, r2 + 2 * yy);
  const std::int32_t du = multiply_high(static_cast<std::int32_t>(shift_round(u, 28)),
                                        static_cast<std::int32_t>(16 * fx));
  const std::int32_t dv = multiply_high(static_cast<std::int32_t>(shift_round(v, 28)),
                                        static_cast<std::int32_t>(16 * fy));
  std::int32_t at[2];
  if (__builtin_add_overflow(du, camera.cx.raw(), &at[0])) return false;
  if (__builtin_add_overflow(dv, camera.cy.raw(), &at[1])) return false;
  pixel = Vec2Px(Px::from_raw(at[0]), Px::from_raw(at[1]));
  return true;
}

}  // namespace

Vec2Ray ray_of(const Vec3Mm& point_mm) {
  const std::int32_t z = positive_depth(point_mm[2]);
  const Reciprocal r = reciprocal(static_cast<std::uint32_t>(z));
  return {ray_component(point_mm[0].raw(), z, r), ray_component(point_mm[1].raw(), z, r)};
}

Vec2Px distort_to_pixel(const Camera& camera, const Vec2Ray& ray) {
  const Distorted d = distort(terms_of(camera, ray));
  return {to_pixel(d.x, camera.fx, camera.cx), to_pixel(d.y, camera.fy, camera.cy)};
}

Vec2Px project(const Camera& camera, const Vec3Mm& point_mm) {
  Vec2Px pixel;
  if (project_mildly(camera, point_mm, pixel)) return pixel;
  return distort_to_pixel(camera, ray_of(point_mm));
}

// Flattened: the terms stay in registers, which saves 40 of 240 instructions.
[[gnu::flatten]] RayProjection distort_with_jacobian(const Camera& camera, const Vec2Ray& ray) {
  const Terms t = terms_of(camera, ray);
  const Distorted d = distort(t);
  RayProjection result;
  result.pixel = {to_pixel(d.x, camera.fx, camera.cx), to_pixel(d.y, camera.fy, camera.cy)};
  result.by_ray = pixels_by_ray(camera, jacobian_of(camera, t));
  return result;
}

bool is_unfolded(const Camera& camera, const Vec2Ray& ray) {
  const DistortionJacobian j = jacobian_of(camera, terms_of(camera, ray));
  return determinant(j) > (std::int64_t{1} << 22);
}

PointProjection project_along_ray(const Camera& camera, const Vec3Mm& point_mm) {
  const std::int32_t z = positive_depth(point_mm[2]);
  PointProjection p;
  p.per_z = reciprocal(static_cast<std::uint32_t>(z));
  p.ray = {ray_component(point_mm[0].raw(), z, p.per_z),
           ray_component(point_mm[1].raw(), z, p.per_z)};
  static_cast<RayProjection&>(p) = distort_with_jacobian(camera, p.ray);
  return p;
}

Projection project_with_jacobian(const Camera& camera, const Vec3Mm& point_mm) {
  const std::int32_t z = positive_depth(point_mm[2]);
  const PointProjection p = project_along_ray(camera, point_mm);
  const Reciprocal r = p.per_z;
  Projection result;
  result.ray = p.ray;
  result.pixel = p.pixel;
  result.by_ray = p.by_ray;
  for (int i = 0; i < 2; ++i) {
    // d/dX = J e_x / Z, d/dY = J e_y / Z, d/dZ = -J (x, y) / Z.
    const std::int32_t jx = p.by_ray(i, 0).raw(), jy = p.by_ray(i, 1).raw();
    const std::int64_t along_ray =
        product(jx, result.ray[0].raw()) + product(jy, result.ray[1].raw());
    result.by_point(i, 0) = per_mm(jx, z, r);
    result.by_point(i, 1) = per_mm(jy, z, r);
    result.by_point(i, 2) = per_mm(clamp32(-shift_round(along_ray, 28)), z, r);
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
