// Pinhole camera with Brown-Conrady distortion (Brown 1971), as OpenCV's plumb_bob model.
//
//   x = X/Z, y = Y/Z, r2 = x^2 + y^2, d = 1 + k1 r2 + k2 r2^2 + k3 r2^3
//   xd = x d + 2 p1 x y + p2 (r2 + 2 x^2),  yd = y d + p1 (r2 + 2 y^2) + 2 p2 x y
//   u = fx xd + cx,  v = fy yd + cy;  the centre of the top-left pixel is (0, 0).
#pragma once

#include <cstdint>

#include "fixed/eigen.hpp"
#include "fixed/q.hpp"

namespace berth {

using Coefficient = Q<24>;  // distortion coefficients: +-128

struct Camera {
  std::int32_t width = 0, height = 0;  // pixels
  Px fx, fy, cx, cy;                   // pixels
  Coefficient k1, k2, p1, p2, k3;
};

using Vec2Px = Eigen::Matrix<Px, 2, 1>;
using Vec2Ray = Eigen::Matrix<Ray, 2, 1>;
using Vec3Mm = Eigen::Matrix<Mm, 3, 1>;
using Vec3Unit = Eigen::Matrix<Unit, 3, 1>;
using Mat3Unit = Eigen::Matrix<Unit, 3, 3>;

}  // namespace berth
