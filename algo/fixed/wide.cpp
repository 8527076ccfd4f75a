// See wide.hpp. Division: Moeller and Granlund, Improved Division by Invariant Integers (IEEE
// Transactions on Computers, 2011), with two digits of 32 bits.
#include "fixed/wide.hpp"

#include "fixed/q.hpp"
#include "fixed/roots.hpp"

namespace berth {
namespace {

std::int64_t with_sign(std::uint64_t value, bool negative) {
  BERTH_RANGE(value < std::uint64_t{1} << 63);
  return static_cast<std::int64_t>(negative ? 0u - value : value);
}

std::uint64_t join(std::uint32_t high, std::uint32_t low) {
  return std::uint64_t{high} << 32 | low;
}

std::uint32_t high_digit(std::uint64_t value) { return static_cast<std::uint32_t>(value >> 32); }
std::uint32_t low_digit(std::uint64_t value) { return static_cast<std::uint32_t>(value); }

// floor((2^64 - 1) / d) - 2^32 for d >= 2^31: four times a mantissa of 31 bits, which is at most
// two too small, then what is missing, up to 8, from a division that may leave one of it.
std::uint32_t inverse_of_digit(std::uint32_t d) {
  const auto mantissa = static_cast<std::uint32_t>(reciprocal(d).mantissa) - 1;
  const std::uint64_t rest = ~(std::uint64_t{mantissa} * d << 2);  // below 9 d < 2^36
  const std::uint32_t missing = static_cast<std::uint32_t>(rest >> 4) / ((d >> 4) + 1);
  const std::uint32_t inverse = 4 * mantissa + missing;
  return rest - std::uint64_t{missing} * d >= d ? inverse + 1 : inverse;
}

// floor((2^96 - 1) / d) - 2^32 for d >= 2^63: algorithm 6 of the same.
std::uint32_t inverse_of(std::uint64_t d) {
  const std::uint32_t d1 = high_digit(d), d0 = low_digit(d);
  std::uint32_t inverse = inverse_of_digit(d1);
  std::uint32_t p = d1 * inverse + d0;
  if (p < d0) {
    --inverse;
    if (p >= d1) {
      --inverse;
      p -= d1;
    }
    p -= d1;
  }
  const std::uint64_t t = std::uint64_t{inverse} * d0;
  p += high_digit(t);
  if (p < high_digit(t)) {
    --inverse;
    if (join(p, low_digit(t)) >= d) --inverse;
  }
  return inverse;
}

// One digit of (high 2^32 + next) / d, high < d, which becomes the remainder: algorithm 4 of it.
std::uint32_t quotient_digit(std::uint64_t& high, std::uint32_t next, std::uint64_t d,
                             std::uint32_t inverse) {
  const std::uint64_t estimate = std::uint64_t{inverse} * high_digit(high) + high;
  std::uint32_t q = high_digit(estimate);
  std::uint64_t rest =
      join(low_digit(high) - q * high_digit(d), next) - std::uint64_t{low_digit(d)} * q - d;
  ++q;
  if (high_digit(rest) >= low_digit(estimate)) {
    --q;
    rest += d;
  }
  if (rest >= d) {
    ++q;
    rest -= d;
  }
  high = rest;
  return q;
}

}  // namespace

std::uint64_t divide_wide(Wide128 n, std::uint64_t d) {
  BERTH_RANGE(n.high < d);
  if (n.high == 0) return n.low / d;
  const int s = leading_zeros64(d);
  const std::uint64_t v = d << s;
  std::uint64_t rest = s == 0 ? n.high : (n.high << s) | (n.low >> (64 - s));
  const std::uint64_t low = n.low << s;
  const std::uint32_t inverse = inverse_of(v);
  const std::uint32_t first = quotient_digit(rest, high_digit(low), v, inverse);
  return join(first, quotient_digit(rest, low_digit(low), v, inverse));
}

std::int64_t multiply_60(std::int64_t a, std::int64_t b) {
  BERTH_RANGE(magnitude(a) <= std::uint64_t{1} << 60 && magnitude(b) <= std::uint64_t{1} << 60);
  // Digits of 32 and 31 bits, the last bit left out: a = a1 2^32 + a0 2.
  const std::int32_t a1 = upper_word(a), b1 = upper_word(b);
  const auto a0 = static_cast<std::int32_t>(low_digit(static_cast<std::uint64_t>(a)) >> 1);
  const auto b0 = static_cast<std::int32_t>(low_digit(static_cast<std::uint64_t>(b)) >> 1);
  std::int64_t middle = 2 * std::int64_t{multiply_high(a0, b0)};  // by 2^-33, below 2^61
  add_product(middle, a1, b0);
  add_product(middle, b1, a0);
  return std::int64_t{a1} * b1 * 16 + ((middle + (1 << 26)) >> 27);
}

std::int64_t mul_shift(std::int64_t a, std::int64_t b, int shift) {
  BERTH_RANGE(shift >= 0 && shift <= 126);
  Wide128 p = multiply_wide(magnitude(a), magnitude(b));
  const bool negative = (a < 0) != (b < 0);
  if (shift == 0) return with_sign(p.low, negative);
  if (shift > 64) {
    const std::uint64_t half = std::uint64_t{1} << (shift - 65);
    return with_sign((p.high + half) >> (shift - 64), negative);
  }
  const std::uint64_t low = p.low + (std::uint64_t{1} << (shift - 1));
  if (low < p.low) ++p.high;
  if (shift == 64) return with_sign(p.high, negative);
  BERTH_RANGE(p.high >> (shift - 1) == 0);
  return with_sign((p.high << (64 - shift)) | (low >> shift), negative);
}

std::int64_t div_shift(std::int64_t a, int shift, std::int64_t b) {
  BERTH_RANGE(shift >= 0 && shift <= 63 && b != 0);
  const std::uint64_t m = magnitude(a);
  const std::uint64_t d = magnitude(b);
  Wide128 n{shift == 0 ? 0 : m >> (64 - shift), m << shift};
  const std::uint64_t low = n.low + d / 2;
  if (low < n.low) ++n.high;
  n.low = low;
  return with_sign(divide_wide(n, d), (a < 0) != (b < 0));
}

std::int64_t scale_by_power(std::int64_t value, int shift) {
  if (shift <= -63) return 0;
  BERTH_RANGE(shift <= 0 || value == 0 || bit_length(value) + shift <= 63);
  if (shift >= 63) return 0;  // of zero: nothing else fits
  return shift_by(value, shift);
}

int block_shift(const std::int64_t* values, int count, int bits) {
  int longest = 0;
  for (int i = 0; i < count; ++i) {
    const int length = bit_length(values[i]);
    if (length > longest) longest = length;
  }
  return longest == 0 ? 0 : bits - longest;
}

}  // namespace berth
