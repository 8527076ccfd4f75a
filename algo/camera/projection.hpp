// Projection of points and rays into the distorted image and back (equations in camera.hpp).
//
// 32-bit mantissas and 32 x 32 -> 64 bit products throughout. A ray outside |x|, |y| <= kMaxRay, or
// so far outside the image that the polynomial leaves its format, saturates: the pixel is then far
// from the true one but never undefined. As in OpenCV, rays well outside the image of a barrel lens
// fold back into it; is_unfolded() tells.
#pragma once

#include "camera/camera.hpp"
#include "fixed/roots.hpp"

namespace berth {

using PxPerMm = Q<24>;  // +-128 px/mm
using Mat2Px = Eigen::Matrix<Px, 2, 2>;
using Mat23PxPerMm = Eigen::Matrix<PxPerMm, 2, 3>;

/// Rays are clamped to this in x and y, 127 degrees of field; just below 2, so that x^2 + y^2 < 8.
constexpr Ray kMaxRay = q<28>(2.0 - 1.0 / 1048576.0);

/// (X/Z, Y/Z), clamped to kMaxRay. z > 0 (z <= 0 counts as the smallest z). Error 0.6 2^-28, twice
/// that from 4096 mm on. Cost: about 70 instructions, without a 64-bit division.
Vec2Ray ray_of(const Vec3Mm& point_mm);

/// Pixel of a ray. Error below 2^-15 px for rays in the image of a valid camera. Cost: about 120.
Vec2Px distort_to_pixel(const Camera& camera, const Vec2Ray& ray);

/// Pixel of a point in the camera frame: distort_to_pixel(ray_of()). Error below 2^-14 px. Cost:
/// about 130.
Vec2Px project(const Camera& camera, const Vec3Mm& point_mm);

/// d(u, v) / d(x, y) of distort_to_pixel, px per unit of ray (and per rad on the axis). Relative
/// error of Jacobians: 2^-16 (1 + x^2 + y^2)^2. Cost: about 200.
struct RayProjection {
  Vec2Px pixel;
  Mat2Px by_ray;  // symmetric up to fx / fy
};
RayProjection distort_with_jacobian(const Camera& camera, const Vec2Ray& ray);

/// Whether the distortion is invertible at this ray: the determinant of its Jacobian is above 1/16.
bool is_unfolded(const Camera& camera, const Vec2Ray& ray);

/// Pixel, ray, by_ray and 1 / z of a point: d(u, v) / d(X, Y, Z) = by_ray [1 0 -x; 0 1 -y] / z.
/// Cost: about 330.
struct PointProjection : RayProjection {
  Vec2Ray ray;
  Reciprocal per_z;
};
PointProjection project_along_ray(const Camera& camera, const Vec3Mm& point_mm);

/// Pixel, ray and d(u, v) / d(X, Y, Z) in px per mm, saturated at 128 px/mm. Cost: about 400.
struct Projection {
  Vec2Px pixel;
  Vec2Ray ray;
  Mat2Px by_ray;
  Mat23PxPerMm by_point;
};
Projection project_with_jacobian(const Camera& camera, const Vec3Mm& point_mm);

/// Inverse of distort_to_pixel by four Newton steps; |distort_to_pixel(result) - pixel| < 2^-14 px
/// over the image of a valid camera. Cost: about 1450.
Vec2Ray undistort(const Camera& camera, const Vec2Px& pixel);

/// One Newton step from a start that is already near: for neighbours on a contour. Quadratic: an
/// error e of the start leaves about |k1| e^2. Cost: about 400.
Vec2Ray undistort_from(const Camera& camera, const Vec2Px& pixel, const Vec2Ray& start);

}  // namespace berth
