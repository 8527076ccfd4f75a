// Sine, cosine, arc tangent and their kin on angles of 2^-28 rad.
//
// Sine and cosine: reduction to |r| <= pi/4 with pi/2 of 60 fraction bits, Taylor polynomials of
// degree 11 and 10 there. Arc tangent: reduction by the nearest atan(k/8), then its series on
// |t| <= 1/15. Every branch is exact integer arithmetic: same bits on every machine.
#pragma once

#include <cstdint>

#include "fixed/q.hpp"

namespace berth {

constexpr Angle kPi = q<28>(3.14159265358979323846);
constexpr Angle kHalfPi = q<28>(1.57079632679489661923);

/// 2 pi k / n, rounded down; 0 <= k <= n < 2^15. Without a 64-bit division.
constexpr Angle part_of_turn(std::int32_t k, std::int32_t n) {
  constexpr std::int32_t kTurn = 2 * kPi.raw();
  return Angle::from_raw(kTurn / n * k + kTurn % n * k / n);
}

struct SinCos {
  Unit sin, cos;
};

/// Every Angle. Error below 1.5 2^-30 of the angle as represented. Cost: about 65 instructions.
SinCos sin_cos(Angle angle);

/// Direction of (x, y) in (-pi, pi], any common unit; 0 for (0, 0). Error below 0.95 2^-28 rad.
/// Cost: about 230 instructions.
Angle atan2(std::int32_t y, std::int32_t x);

/// asin in [-pi/2, pi/2], acos in [0, pi]; |value| beyond 1 counts as 1. Error below 2^-28 rad
/// of the value as represented, and well conditioned up to |value| = 1. Cost: about 310.
Angle asin(Unit value);
Angle acos(Unit value);

}  // namespace berth
