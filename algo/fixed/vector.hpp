// Products of short vectors with one rounding: sums of exact 64-bit products.
//
// Eigen's own products round every term and cannot mix formats in dot(); these do neither. Where
// the result's format cannot hold it, that is a range violation like any other.
#pragma once

#include <cstdint>

#include "fixed/eigen.hpp"
#include "fixed/q.hpp"
#include "fixed/roots.hpp"

namespace berth {

template <int F, int N = 3>
using VectorQ = Eigen::Matrix<Q<F>, N, 1>;

/// sum + product without leaving 64 bits (a range statement; wraps in flight).
inline std::int64_t accumulate(std::int64_t sum, std::int64_t product) {
  std::int64_t result = 0;
  [[maybe_unused]] const bool overflow = __builtin_add_overflow(sum, product, &result);
  BERTH_RANGE(!overflow);
  return result;
}

/// a . b with A + B fraction bits, exact. |a| |b| < 2^63 in raw units.
template <int A, int B, int N>
std::int64_t dot_exact(const VectorQ<A, N>& a, const VectorQ<B, N>& b) {
  std::int64_t sum = 0;
  for (int i = 0; i < N; ++i) sum = accumulate(sum, std::int64_t{a[i].raw()} * b[i].raw());
  return sum;
}

/// a . b in a format of the caller's choice, rounded once. A + B >= R.
template <int R, int A, int B, int N>
Q<R> dot(const VectorQ<A, N>& a, const VectorQ<B, N>& b) {
  static_assert(A + B >= R);
  return Q<R>::from_wide(shift_round(dot_exact(a, b), A + B - R));
}

/// a x b in a format of the caller's choice, each element rounded once.
template <int R, int A, int B>
VectorQ<R> cross(const VectorQ<A>& a, const VectorQ<B>& b) {
  static_assert(A + B >= R);
  const auto minor = [&a, &b](int i, int j) {
    const std::int64_t positive = std::int64_t{a[i].raw()} * b[j].raw();
    const std::int64_t negative = std::int64_t{a[j].raw()} * b[i].raw();
    return Q<R>::from_wide(shift_round(accumulate(positive, -negative), A + B - R));
  };
  return {minor(1, 2), minor(2, 0), minor(0, 1)};
}

/// rotation * p in p's format, each element rounded once: for points, a third of Eigen's error.
template <int F>
VectorQ<F> rotate(const Eigen::Matrix<Unit, 3, 3>& rotation, const VectorQ<F>& p) {
  const auto row = [&](int i) {
    std::int64_t sum = std::int64_t{rotation(i, 0).raw()} * p[0].raw();
    sum = accumulate(sum, std::int64_t{rotation(i, 1).raw()} * p[1].raw());
    sum = accumulate(sum, std::int64_t{rotation(i, 2).raw()} * p[2].raw());
    return Q<F>::from_wide(shift_round(sum, Unit::kFraction));
  };
  return {row(0), row(1), row(2)};
}

/// |v| to nearest, in v's format. Cost: about 80 instructions.
template <int F>
Q<F> norm(const VectorQ<F>& v) {
  std::uint64_t sum = 0;  // at most 3 2^62 < 2^64
  for (int i = 0; i < 3; ++i) {
    sum += static_cast<std::uint64_t>(std::int64_t{v[i].raw()} * v[i].raw());
  }
  return Q<F>::from_wide(isqrt_nearest(sum));
}

/// v / |v| of raw numbers, error of each element below 1.2 2^-30; false, and `unit` untouched, for
/// the null vector. Cost: about 250 instructions.
bool normalize_raw(const std::int32_t (&v)[3], Unit (&unit)[3]);

/// v / |v|. Precondition: v is not null (a range statement; null in, null out in flight).
template <int F>
VectorQ<30> normalized(const VectorQ<F>& v) {
  const std::int32_t raw[3] = {v[0].raw(), v[1].raw(), v[2].raw()};
  Unit unit[3];
  [[maybe_unused]] const bool is_unit = normalize_raw(raw, unit);
  BERTH_RANGE(is_unit);
  return {unit[0], unit[1], unit[2]};
}

}  // namespace berth
