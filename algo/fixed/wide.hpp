// 128-bit products and quotients of 64-bit numbers, made of 32-bit partial products.
//
// For the few places whose values outgrow Q<F>: normal equations, eigenvalues, resultants.
// Rounding is to nearest, halves away from zero, so that f(-a) = -f(a); of multiply_60 to two
// units.
#pragma once

#include <cstdint>

#include "core/check.hpp"

namespace berth {

/// Zeros above the leading one; 32 (64) for zero. Cost: 1 (3) instructions.
inline int leading_zeros32(std::uint32_t value) { return value == 0 ? 32 : __builtin_clz(value); }
inline int leading_zeros64(std::uint64_t value) {
  const auto high = static_cast<std::uint32_t>(value >> 32);
  return high != 0 ? __builtin_clz(high) : 32 + leading_zeros32(static_cast<std::uint32_t>(value));
}

/// |value| as an unsigned number, also of the most negative one.
inline std::uint64_t magnitude(std::int64_t value) {
  const auto bits = static_cast<std::uint64_t>(value);
  return value < 0 ? 0u - bits : bits;
}

/// Bits of |value|: 2^(n-1) <= |value| < 2^n, 0 for zero.
inline int bit_length(std::int64_t value) { return 64 - leading_zeros64(magnitude(value)); }

/// sum += a b. Without the barrier GCC 12 widens a factor of several such products once and then
/// multiplies 64 bits by 32 each time: five instructions instead of one.
[[gnu::always_inline]] inline void add_product(std::int64_t& sum, std::int32_t a, std::int32_t b) {
#if defined(__arm__)
  asm("" : "+r"(b));
#endif
  sum += std::int64_t{a} * b;
}

/// Upper word, as a factor of one instruction: GCC 12 makes the 64-bit shift a 64-bit factor.
[[gnu::always_inline]] inline std::int32_t upper_word(std::int64_t value) {
  auto word = static_cast<std::int32_t>(value >> 32);
#if defined(__arm__)
  asm("" : "+r"(word));
#endif
  return word;
}

namespace portable {
inline std::int32_t multiply_high(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>((std::int64_t{a} * b + (std::int64_t{1} << 31)) >> 32);
}
}  // namespace portable

/// v 2^up, a range statement: for the factors of multiply_high.
inline std::int32_t raised(std::int32_t v, int up) {
  BERTH_RANGE(std::int64_t{v} * (std::int64_t{1} << up) <= INT32_MAX &&
              std::int64_t{v} * (std::int64_t{1} << up) >= INT32_MIN);
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(v) << up);
}

/// round(v / 2^down), halves up: shift_round within 32 bits. v + 2^(down - 1) < 2^31, 1 <= down
/// < 31.
inline std::int32_t lowered(std::int32_t v, int down) {
  BERTH_RANGE(down >= 1 && down < 31 && v <= INT32_MAX - (1 << (down - 1)));
  return (v + (1 << (down - 1))) >> down;
}

/// round(a b / 2^32), halves up: a product of two fractions in one instruction, where a shift by
/// fewer bits can be had by shifting a factor left beforehand.
inline std::int32_t multiply_high(std::int32_t a, std::int32_t b) {
#if defined(__arm__)
  std::int32_t result;
  asm("smmulr %0, %1, %2" : "=r"(result) : "r"(a), "r"(b));
  return result;
#else
  return portable::multiply_high(a, b);
#endif
}

/// Unsigned 128-bit number.
struct Wide128 {
  std::uint64_t high = 0, low = 0;
};

/// Exact product. Cost: about 15 instructions.
inline Wide128 multiply_wide(std::uint64_t a, std::uint64_t b) {
  const std::uint64_t a0 = a & 0xffffffffu, a1 = a >> 32;
  const std::uint64_t b0 = b & 0xffffffffu, b1 = b >> 32;
  const std::uint64_t p00 = a0 * b0, p01 = a0 * b1;
  const std::uint64_t middle = a1 * b0 + (p00 >> 32) + (p01 & 0xffffffffu);  // at most 2^64 - 1
  return {a1 * b1 + (middle >> 32) + (p01 >> 32), (middle << 32) | (p00 & 0xffffffffu)};
}

/// Floor of n / d. Precondition: n.high < d, so that the quotient has 64 bits. Cost: about 130.
std::uint64_t divide_wide(Wide128 n, std::uint64_t d);

/// round(a b / 2^shift), 0 <= shift <= 126. |result| < 2^63 (a range statement). Cost: about 70.
std::int64_t mul_shift(std::int64_t a, std::int64_t b, int shift);

/// mul_shift(a, b, 60) for |a|, |b| <= 2^60, to two units. Cost: about 20.
std::int64_t multiply_60(std::int64_t a, std::int64_t b);

/// round(a 2^shift / b), 0 <= shift <= 63, b != 0. |result| < 2^63 (a range statement).
/// Cost: about 100 where |a| 2^shift fits 62 bits, 180 elsewhere.
std::int64_t div_shift(std::int64_t a, int shift, std::int64_t b);

/// shift_by() for any shift: beyond 62 to the right nothing is left. Left shifts must fit.
std::int64_t scale_by_power(std::int64_t value, int shift);

/// Shared exponent of a block: the left shift after which the largest of the `count` values has
/// exactly `bits` bits (negative: a right shift; 0 when all are zero).
int block_shift(const std::int64_t* values, int count, int bits);

}  // namespace berth
