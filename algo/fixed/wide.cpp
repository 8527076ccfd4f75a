// See wide.hpp. Division: Knuth, The Art of Computer Programming 2, 4.3.1, algorithm D, with two
// digits of 32 bits.
#include "fixed/wide.hpp"

#include "fixed/q.hpp"

namespace berth {
namespace {

constexpr std::uint64_t kDigit = std::uint64_t{1} << 32;

std::uint64_t low_digit(std::uint64_t value) { return value & (kDigit - 1); }

std::int64_t with_sign(std::uint64_t value, bool negative) {
  BERTH_RANGE(value < std::uint64_t{1} << 63);
  return static_cast<std::int64_t>(negative ? 0u - value : value);
}

// One digit of (high 2^32 + next) / v, v normalised; the estimate is at most two too large.
std::uint64_t quotient_digit(std::uint64_t high, std::uint64_t next, std::uint64_t v) {
  const std::uint64_t v1 = v >> 32;
  const std::uint64_t v0 = low_digit(v);
  std::uint64_t q = high / v1;
  std::uint64_t rest = high - q * v1;
  for (int i = 0; i < 2; ++i) {
    if (rest >= kDigit || (q < kDigit && q * v0 <= (rest << 32) + next)) break;
    --q;
    rest += v1;
  }
  return q;
}

}  // namespace

std::uint64_t divide_wide(Wide128 n, std::uint64_t d) {
  BERTH_RANGE(n.high < d);
  if (n.high == 0) return n.low / d;
  const int s = leading_zeros64(d);
  const std::uint64_t v = d << s;
  const std::uint64_t high = s == 0 ? n.high : (n.high << s) | (n.low >> (64 - s));
  const std::uint64_t low = n.low << s;
  const std::uint64_t q1 = quotient_digit(high, low >> 32, v);
  const std::uint64_t rest = (high << 32) + (low >> 32) - q1 * v;
  return (q1 << 32) + quotient_digit(rest, low_digit(low), v);
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
