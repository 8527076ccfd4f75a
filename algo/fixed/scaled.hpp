// Scaled: a 64-bit integer with a binary exponent of its own (a block exponent of block size one).
//
// value = mantissa * 2^exponent with mantissa = 0 or 2^61 <= |mantissa| < 2^62. For the short,
// ill-scaled algebra of the pose stages (minimal solver, 6 x 6 solutions), whose products span more
// than any Q format holds. Every operation is exact to 2^-59 of its result (sums: of the larger
// term) and truncates the same way on every platform; 32 x 32 -> 64 multiplications only.
// Overflow is impossible: exponents stay within +-2^20 (proven in the range-checking build).
// Cost on a Cortex-M7, instructions: * about 45, + - about 50, / about 220, sqrt about 350.
#pragma once

#include <cstdint>

#include "fixed/q.hpp"

namespace berth {

class Scaled {
 public:
  constexpr Scaled() = default;
  Scaled(int value) : Scaled(from_raw(value, 0)) {}
  /// raw / 2^fraction. |raw| < 2^63, |fraction| < 2^20.
  static Scaled from_raw(std::int64_t raw, int fraction);
  template <int F>
  explicit Scaled(Q<F> value) : Scaled(from_raw(value.raw(), F)) {}

  /// Nearest multiple of 2^-fraction, as an integer; clamped to +-(2^62 - 1).
  std::int64_t to_raw(int fraction) const;
  /// Nearest value of the format, clamped to its range.
  template <int F>
  Q<F> to() const {
    return Q<F>::saturated(to_raw(F));
  }

  bool is_zero() const { return mantissa_ == 0; }
  bool is_negative() const { return mantissa_ < 0; }
  /// floor(log2 |value|). Precondition: not zero.
  int log2() const { return exponent_ + 61; }
  /// value * 2^power, exact.
  Scaled times_power_of_two(int power) const;

  Scaled operator-() const;
  friend Scaled operator+(const Scaled& a, const Scaled& b);
  friend Scaled operator-(const Scaled& a, const Scaled& b);
  friend Scaled operator*(const Scaled& a, const Scaled& b);
  /// Precondition: b is not zero.
  friend Scaled operator/(const Scaled& a, const Scaled& b);
  Scaled& operator+=(const Scaled& b) { return *this = *this + b; }
  Scaled& operator-=(const Scaled& b) { return *this = *this - b; }
  Scaled& operator*=(const Scaled& b) { return *this = *this * b; }

  friend bool operator<(const Scaled& a, const Scaled& b);
  friend bool operator>(const Scaled& a, const Scaled& b) { return b < a; }
  friend bool operator<=(const Scaled& a, const Scaled& b) { return !(b < a); }
  friend bool operator>=(const Scaled& a, const Scaled& b) { return !(a < b); }
  friend bool operator==(const Scaled& a, const Scaled& b) {
    return a.mantissa_ == b.mantissa_ && (a.exponent_ == b.exponent_ || a.mantissa_ == 0);
  }

  /// Square root, exact to 2^-58 of the result. Precondition: value >= 0.
  friend Scaled sqrt(const Scaled& value);
  friend Scaled abs(const Scaled& value) { return value.is_negative() ? -value : value; }

 private:
  static Scaled normalized(std::int64_t mantissa, int exponent);
  static Scaled reciprocal(const Scaled& value);

  std::int64_t mantissa_ = 0;
  std::int32_t exponent_ = 0;
};

Scaled sqrt(const Scaled& value);
Scaled abs(const Scaled& value);

}  // namespace berth
