// The blurred step as a table: how bright a pixel is at a signed distance from an edge.
//
//   P(x) = (u * p)(x), p = Gaussian (variance 1 - f) * box (variance f), x = distance / sigma
//
// in units of the blur's standard deviation across the edge; u is the unit step. f = 0 is defocus,
// f towards 1 straight motion across the edge. Point-symmetric PSFs make P(x) - 1/2 odd and its
// derivative even, so an estimator that weighs residuals by the derivative is unbiased for any
// symmetric blur; the right f only makes it efficient.
#pragma once

#include <cstdint>

#include "image/packed.hpp"

namespace berth {

constexpr int kProfileShapes = 8;     // f = 0, 1/8, ... 7/8
constexpr int kProfileStepsLog2 = 4;  // 16 table entries per sigma
constexpr int kProfileReach = 4;      // tabulated over |x| <= 4
constexpr int kProfileEntries = 2 * kProfileReach * (1 << kProfileStepsLog2) + 1;
constexpr int kProfileFraction = 13;  // P and its derivative are Q<13>

struct EdgeProfile {
  std::int16_t step[kProfileEntries];  // P(x), 0..1
};

/// Table of one shape, 0 <= shape < kProfileShapes.
const EdgeProfile& edge_profile(int shape);

/// P and dP/dx at x (Q<12>, any value), both Q<13>. P by linear interpolation, error below 1.3e-4;
/// the derivative is that of the interpolation, to 0.003, since it serves as a weight only.
struct ProfileValue {
  std::int32_t step, slope;
};
inline ProfileValue look_up(const EdgeProfile& profile, std::int32_t x_q12) {
  constexpr std::int32_t kLimit = kProfileReach << 12;
  if (x_q12 <= -kLimit) return {0, 0};
  if (x_q12 >= kLimit) return {1 << kProfileFraction, 0};
  const std::int32_t shifted = x_q12 + kLimit;  // 1 .. 2 kLimit - 1
  constexpr int kShift = 12 - kProfileStepsLog2;
  const std::int32_t index = shifted >> kShift;
  const std::int32_t part = shifted & ((1 << kShift) - 1);
  const std::int32_t low = profile.step[index];
  const std::int32_t rise = profile.step[index + 1] - low;  // at most 2^13 / 16
  return {low + ((rise * part + (1 << (kShift - 1))) >> kShift), rise * (1 << kProfileStepsLog2)};
}

/// The same for a place counted from the table's start, y = x + kProfileReach in Q<24>: the y of a
/// run of pixels comes from differences, and wraps where it is far outside.
inline ProfileValue look_up_from_start(const EdgeProfile& profile, std::uint32_t y_q24) {
  if (y_q24 >= (2u * kProfileReach) << 24) {
    return {y_q24 >> 31 != 0 ? 0 : 1 << kProfileFraction, 0};
  }
  constexpr int kShift = 24 - kProfileStepsLog2;
  const Pair entries = load(&profile.step[y_q24 >> kShift]);
  const auto part = static_cast<std::int32_t>(y_q24 >> (kShift - 8) & 0xffu);
  const auto low = static_cast<std::int16_t>(entries & 0xffffu);
  const std::int32_t rise = static_cast<std::int16_t>(entries >> 16) - low;
  return {low + ((rise * part + 128) >> 8), rise * (1 << kProfileStepsLog2)};
}

}  // namespace berth
