#include "fixed/scaled.hpp"

#include "fixed/roots.hpp"
#include "fixed/wide.hpp"

namespace berth {
namespace {

constexpr std::int64_t kLargest = (std::int64_t{1} << 62) - 1;

}  // namespace

Scaled Scaled::normalized(std::int64_t mantissa, int exponent) {
  Scaled out;
  if (mantissa == 0) return out;
  const int shift = leading_zeros64(magnitude(mantissa)) - 2;  // -1 .. 61
  out.mantissa_ = shift < 0
                      ? mantissa / 2
                      : static_cast<std::int64_t>(static_cast<std::uint64_t>(mantissa) << shift);
  out.exponent_ = exponent - shift;
  BERTH_RANGE(out.exponent_ > -(1 << 20) && out.exponent_ < (1 << 20));
  return out;
}

Scaled Scaled::from_raw(std::int64_t raw, int fraction) { return normalized(raw, -fraction); }

std::int64_t Scaled::to_raw(int fraction) const {
  const int shift = exponent_ + fraction;
  if (mantissa_ == 0 || shift < -62) return 0;
  if (shift > 0) return mantissa_ < 0 ? -kLargest : kLargest;
  return shift == -62 ? (mantissa_ + (std::int64_t{1} << 61)) >> 62
                      : shift_round(mantissa_, -shift);
}

Scaled Scaled::times_power_of_two(int power) const {
  Scaled out = *this;
  out.exponent_ += power;
  return out;
}

Scaled Scaled::operator-() const {
  Scaled out = *this;
  out.mantissa_ = -mantissa_;
  return out;
}

Scaled operator+(const Scaled& a, const Scaled& b) {
  if (a.mantissa_ == 0) return b;
  if (b.mantissa_ == 0) return a;
  const bool is_a_larger = a.exponent_ >= b.exponent_;
  const Scaled& large = is_a_larger ? a : b;
  const Scaled& small = is_a_larger ? b : a;
  const int shift = large.exponent_ - small.exponent_;
  if (shift > 62) return large;
  return Scaled::normalized(large.mantissa_ + (small.mantissa_ >> shift), large.exponent_);
}

Scaled operator-(const Scaled& a, const Scaled& b) { return a + (-b); }

Scaled operator*(const Scaled& a, const Scaled& b) {
  const Wide128 product = multiply_wide(magnitude(a.mantissa_), magnitude(b.mantissa_));  // < 2^124
  const auto mantissa = static_cast<std::int64_t>((product.high << 3) | (product.low >> 61));
  const bool is_negative = (a.mantissa_ < 0) != (b.mantissa_ < 0);
  return Scaled::normalized(is_negative ? -mantissa : mantissa, a.exponent_ + b.exponent_ + 61);
}

/// Seed of 30 bits, then one Newton step r <- r + r (1 - v r).
Scaled Scaled::reciprocal(const Scaled& value) {
  const Reciprocal seed =
      berth::reciprocal(static_cast<std::uint32_t>(magnitude(value.mantissa_) >> 30));
  const std::int64_t mantissa = value.mantissa_ < 0 ? -std::int64_t{seed.mantissa} : seed.mantissa;
  const Scaled r = normalized(mantissa, seed.shift - 62 - 30 - value.exponent_);
  return r + r * (Scaled(1) - value * r);
}

Scaled operator/(const Scaled& a, const Scaled& b) {
  BERTH_RANGE(b.mantissa_ != 0);
  if (a.mantissa_ == 0 || b.mantissa_ == 0) return Scaled();
  return a * Scaled::reciprocal(b);
}

bool operator<(const Scaled& a, const Scaled& b) { return (a - b).is_negative(); }

/// Root of the mantissa to 31 bits, then one Newton step s <- (s + v / s) / 2.
Scaled sqrt(const Scaled& value) {
  BERTH_RANGE(!value.is_negative());
  if (value.mantissa_ <= 0) return Scaled();
  const int parity = value.exponent_ & 1;
  const std::uint64_t even = magnitude(value.mantissa_) << parity;  // < 2^63
  const Scaled seed = Scaled::from_raw(isqrt(even), -((value.exponent_ - parity) / 2));
  return (seed + value / seed).times_power_of_two(-1);
}

}  // namespace berth
