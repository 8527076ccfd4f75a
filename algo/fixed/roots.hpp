// Square roots, reciprocals and lengths of integers, by 32-bit hardware division.
//
// Square root: of 32 bits by Heron's steps from a straight line; of more by Zimmermann, Karatsuba
// Square Root (INRIA RR-3805, 1999): the root of the upper half gives the upper half of the root,
// one division the lower half, one comparison corrects it.
#pragma once

#include <cstdint>

#include "fixed/q.hpp"
#include "fixed/wide.hpp"

namespace berth {

/// floor(sqrt(value)) for every 64-bit value. Cost: about 50 instructions, 25 below 2^32.
std::uint32_t isqrt(std::uint64_t value);

/// sqrt(value) with 16 fraction bits, within 2^-31 of it and two units; value > 0. Cost: about 30.
std::uint32_t root_q16(std::uint32_t value);

/// sqrt(value) to the nearest integer; 2^32 - 1 where it would be 2^32. Cost: about 60.
std::uint32_t isqrt_nearest(std::uint64_t value);

/// sqrt(x^2 + y^2) to the nearest integer; no overflow for any pair of 32-bit numbers.
std::uint32_t hypot(std::int32_t x, std::int32_t y);

/// sqrt(a) in a format of the caller's choice, to nearest. a >= 0; 0 <= 2 R - F <= 33.
template <int R, int F>
Q<R> sqrt(Q<F> a) {
  static_assert(2 * R - F >= 0 && 2 * R - F <= 33, "widen the argument first");
  BERTH_RANGE(a.raw() >= 0);
  return Q<R>::from_wide(isqrt_nearest(static_cast<std::uint64_t>(a.raw()) << (2 * R - F)));
}

/// 1 / value = mantissa 2^(shift - 62), mantissa in [2^30, 2^31).
struct Reciprocal {
  std::int32_t mantissa = 0;
  int shift = 0;  // 0..31
};

/// Upper half of a product of which it holds all: |a b| < 2^63.
inline std::int32_t upper_half(std::uint32_t a, std::int64_t b) {
  const std::uint64_t low = std::uint64_t{a} * static_cast<std::uint32_t>(b);
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(low >> 32) +
                                   a * static_cast<std::uint32_t>(b >> 32));
}

/// Relative error at most 2^-31 (mantissa to nearest, 2^31 clamped). value > 0. Cost: about 30.
inline Reciprocal reciprocal(std::uint32_t value) {
  BERTH_RANGE(value != 0);
  const int shift = leading_zeros32(value);
  const std::uint32_t v = value << shift;
  // Estimate of 2^48 / v to 15 bits, then two Newton steps: 30 bits, then all.
  const std::uint32_t r = 0xffffffffu / (v >> 16);  // 17 bits
  const auto residual_48 =
      static_cast<std::int64_t>((std::uint64_t{1} << 48) - std::uint64_t{v} * r);
  // |product| < 2^17 2^34
  std::uint32_t m = (r << 14) + static_cast<std::uint32_t>(upper_half(r, residual_48) >> 2);
  const auto residual_62 =
      static_cast<std::int64_t>((std::uint64_t{1} << 62) - std::uint64_t{m} * v);
  // |product| < 2^17 2^34
  m += static_cast<std::uint32_t>((upper_half(r, residual_62) + (1 << 15)) >> 16);
  return {m > INT32_MAX ? INT32_MAX : static_cast<std::int32_t>(m), shift};
}

/// x / value with `fraction` bits, given reciprocal(value). Relative error 2^-31 and half a step.
/// 0 <= 62 - shift - fraction < 62. Cost: about 8 instructions.
inline std::int64_t multiply_reciprocal(std::int32_t x, Reciprocal r, int fraction) {
  const int right = 62 - r.shift - fraction;
  BERTH_RANGE(right >= 0 && right < 62);
  return shift_round(std::int64_t{x} * r.mantissa, right);  // |product| <= 2^62 - 2^31
}

/// a 2^fraction / b, saturated, within 2^-13 of it and half a step. b > 0, 0 <= fraction < 32.
/// Cost: about 25 instructions.
inline std::int32_t short_quotient(std::int32_t a, std::int32_t b, int fraction) {
  BERTH_RANGE(b > 0 && fraction >= 0 && fraction < 32);
  // a to 31 bits by b to 16: at least 14 are left.
  const int up = leading_zeros32(static_cast<std::uint32_t>(a ^ (a >> 31)) | 1u) - 1;
  const int zeros = leading_zeros32(static_cast<std::uint32_t>(b));
  const int down = zeros < 16 ? 16 - zeros : 0;
  const std::int32_t quotient = raised(a, up) / (b >> down);
  const int right = up + down - fraction;
  if (right <= 0) return saturate32(std::int64_t{quotient} * (std::int64_t{1} << -right));
  return right < 32 ? ((quotient >> (right - 1)) + 1) >> 1 : 0;
}

/// Divides many 64-bit numbers by one of them: x / value to nearest, |x| < 2^62, saturated to 32
/// bits, relative error 2^-30. Cost: about 50 instructions, then 30 a quotient, where a 64-bit
/// division takes 100 to 250.
class QuickDivisor {
 public:
  explicit QuickDivisor(std::int64_t value) {
    BERTH_RANGE(value > 0);
    const int shift = leading_zeros64(static_cast<std::uint64_t>(value));
    const std::uint64_t normal = static_cast<std::uint64_t>(value) << shift;
    mantissa_ = reciprocal(static_cast<std::uint32_t>(normal >> 32)).mantissa;
    right_ = 63 - shift;
    half_ = (std::int64_t{1} << right_) >> 1;
  }
  [[gnu::always_inline]] std::int32_t quotient(std::int64_t x) const {
    // Twice the upper 64 of 96 bits, below 2^62; 1 / value = mantissa 2^(-31 - right).
    const auto m = static_cast<std::uint32_t>(mantissa_);
    const std::uint64_t low = std::uint64_t{static_cast<std::uint32_t>(x)} * m;
    std::int64_t product = static_cast<std::int64_t>(low >> 32);
    add_product(product, upper_word(x), mantissa_);
    return saturate32((2 * product + half_) >> right_);
  }

 private:
  std::int32_t mantissa_;
  int right_;  // 0..62
  std::int64_t half_;
};

}  // namespace berth
