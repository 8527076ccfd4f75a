// Double-precision side of the arithmetic tests.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "fixed/eigen.hpp"
#include "fixed/q.hpp"

namespace berth_test {

template <int F>
double real(berth::Q<F> value) {
  return std::ldexp(static_cast<double>(value.raw()), -F);
}

template <int F, int Rows, int Columns>
Eigen::Matrix<double, Rows, Columns> real(const Eigen::Matrix<berth::Q<F>, Rows, Columns>& m) {
  Eigen::Matrix<double, Rows, Columns> result;
  for (int i = 0; i < Rows; ++i) {
    for (int j = 0; j < Columns; ++j) result(i, j) = real(m(i, j));
  }
  return result;
}

/// Nearest Q<F> of a number that fits.
template <int F>
berth::Q<F> nearest(double value) {
  return berth::Q<F>::from_wide(std::llround(std::ldexp(value, F)));
}

class Random {
 public:
  std::uint64_t bits() { return engine_(); }
  /// All magnitudes: uniform bits shifted right by 0 to 63.
  std::int64_t any64() {
    const auto number = static_cast<std::int64_t>(bits());
    return number >> (bits() & 63);
  }
  std::int32_t any32() { return static_cast<std::int32_t>(any64() >> 32) >> (bits() & 31); }
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(bits() >> 11) * 0x1p-53;
  }

 private:
  std::mt19937_64 engine_{20170715};
};

}  // namespace berth_test
