// Fixed-point scalar Q<F>: a 32-bit two's complement number with F fraction bits.
//
// value = raw / 2^F, range [-2^(31-F), 2^(31-F)). Sums stay in their format; the product of Q<A>
// and Q<B> is a Q<min(A, B)>, rounded to nearest (halves up), through a 64-bit intermediate.
// Overflow is a range violation: proven absent by the range-checking build, wrapping in flight.
// Cost: + - 1 instruction, * about 4 (SMULL and a 64-bit shift), / about 60 (64-bit division).
#pragma once

#include <cstdint>

#include "core/check.hpp"

namespace berth {

/// Shift right, to nearest, halves towards plus infinity. |value| < 2^62, 0 <= shift < 62.
constexpr std::int64_t shift_round(std::int64_t value, int shift) {
  return shift == 0 ? value : (value + (std::int64_t{1} << (shift - 1))) >> shift;
}

/// Shift left for shift > 0, right with rounding to nearest for shift < 0.
constexpr std::int64_t shift_by(std::int64_t value, int shift) {
  return shift >= 0 ? static_cast<std::int64_t>(static_cast<std::uint64_t>(value) << shift)
                    : shift_round(value, -shift);
}

/// Clamp to the 32-bit range. Cost: 2 instructions where nothing is clamped.
constexpr std::int32_t saturate32(std::int64_t value) {
  const auto low = static_cast<std::int32_t>(value);
  if (low == value) return low;
  return value < 0 ? INT32_MIN : INT32_MAX;
}

template <int F>
class Q {
 public:
  static_assert(F >= 0 && F <= 31);
  static constexpr int kFraction = F;

  constexpr Q() = default;
  /// Small integers (0 and 1 as Eigen writes them).
  constexpr Q(int value)
      : raw_(narrow<std::int32_t>(std::int64_t{value} * (std::int64_t{1} << F))) {}

  static constexpr Q from_raw(std::int32_t raw) {
    Q q;
    q.raw_ = raw;
    return q;
  }
  /// From a 64-bit raw value whose range the caller has argued.
  static constexpr Q from_wide(std::int64_t raw) { return from_raw(narrow<std::int32_t>(raw)); }
  /// From a 64-bit raw value, clamped.
  static constexpr Q saturated(std::int64_t raw) { return from_raw(saturate32(raw)); }
  static constexpr Q max() { return from_raw(INT32_MAX); }
  static constexpr Q lowest() { return from_raw(INT32_MIN); }

  constexpr std::int32_t raw() const { return raw_; }
  /// Same value in another format, rounded to nearest; out of range is a range violation.
  template <int G>
  constexpr Q<G> to() const {
    return Q<G>::from_wide(shift_by(raw_, G - F));
  }
  /// Same value in another format, rounded to nearest, clamped to the format's range.
  template <int G>
  constexpr Q<G> to_saturated() const {
    return Q<G>::saturated(shift_by(raw_, G - F));
  }
  /// Nearest integer, halves up.
  constexpr std::int32_t round() const { return static_cast<std::int32_t>(shift_round(raw_, F)); }
  /// Largest integer not above.
  constexpr std::int32_t floor() const { return raw_ >> F; }

  friend constexpr Q operator+(Q a, Q b) { return from_wide(std::int64_t{a.raw_} + b.raw_); }
  friend constexpr Q operator-(Q a, Q b) { return from_wide(std::int64_t{a.raw_} - b.raw_); }
  constexpr Q operator-() const { return from_wide(-std::int64_t{raw_}); }
  constexpr Q& operator+=(Q b) { return *this = *this + b; }
  constexpr Q& operator-=(Q b) { return *this = *this - b; }
  template <int G>
  constexpr Q& operator*=(Q<G> b) {
    return *this = Q::from_wide(shift_round(std::int64_t{raw_} * b.raw(), G));
  }

  friend constexpr bool operator==(Q a, Q b) { return a.raw_ == b.raw_; }
  friend constexpr bool operator!=(Q a, Q b) { return a.raw_ != b.raw_; }
  friend constexpr bool operator<(Q a, Q b) { return a.raw_ < b.raw_; }
  friend constexpr bool operator<=(Q a, Q b) { return a.raw_ <= b.raw_; }
  friend constexpr bool operator>(Q a, Q b) { return a.raw_ > b.raw_; }
  friend constexpr bool operator>=(Q a, Q b) { return a.raw_ >= b.raw_; }

 private:
  std::int32_t raw_ = 0;
};

/// Product in the coarser of the two formats, rounded to nearest.
template <int A, int B>
constexpr Q<(A < B ? A : B)> operator*(Q<A> a, Q<B> b) {
  return Q<(A < B ? A : B)>::from_wide(shift_round(std::int64_t{a.raw()} * b.raw(), A < B ? B : A));
}

/// Product in a format of the caller's choice, rounded to nearest. A + B >= R.
template <int R, int A, int B>
constexpr Q<R> mul(Q<A> a, Q<B> b) {
  static_assert(A + B >= R);
  return Q<R>::from_wide(shift_round(std::int64_t{a.raw()} * b.raw(), A + B - R));
}

/// Quotient a / b in a format of the caller's choice, to nearest (halves away from zero). b != 0.
template <int R, int A, int B>
constexpr Q<R> div(Q<A> a, Q<B> b) {
  BERTH_RANGE(b.raw() != 0);
  static_assert(R + B - A >= 0 && R + B - A <= 32);
  const std::int64_t n = std::int64_t{a.raw()} * (std::int64_t{1} << (R + B - A));
  const std::int64_t d = b.raw();
  const std::int64_t half = (d < 0 ? -d : d) / 2;
  const std::int64_t away = n < 0 ? n - half : n + half;
  return Q<R>::from_wide(away / d);
}

template <int F>
constexpr Q<F> abs(Q<F> a) {
  return a.raw() < 0 ? -a : a;
}

/// Compile-time constants only: q<16>(0.6). The literal never reaches the target.
template <int F>
constexpr Q<F> q(double value) {
  const double scaled = value * static_cast<double>(std::int64_t{1} << F);
  return Q<F>::from_wide(static_cast<std::int64_t>(scaled < 0 ? scaled - 0.5 : scaled + 0.5));
}

// The formats of the interfaces.
using Px = Q<16>;     // image coordinates, pixels: +-32768, step 1.5e-5
using Mm = Q<18>;     // lengths, millimetres: +-8192, step 3.8e-6
using Unit = Q<30>;   // rotation matrices, quaternions, unit vectors, correlations: +-2
using Ray = Q<28>;    // normalised image coordinates x/z, y/z: +-8
using Angle = Q<28>;  // radians: +-8

}  // namespace berth
