#include "host_sim/render/det_math.hpp"

#include <cmath>

namespace berth::host {
namespace {

constexpr double kLn2High = 6.93147180369123816490e-01;  // 33 bits, so that k * kLn2High is exact
constexpr double kLn2Low = 1.90821492927058770002e-10;

// pi/2 in three parts of 33 bits: k times each of the first two is exact for |k| < 2^20.
constexpr double kHalfPi1 = 1.57079632673412561417e+00;
constexpr double kHalfPi2 = 6.07710050630396597660e-11;
constexpr double kHalfPi3 = 2.02226624879595063154e-21;

// Taylor series on |r| <= pi/4; the first term left out is below 1e-19.
double sin_series(double r) {
  const double r2 = r * r;
  double sum = 0.0;
  for (int n = 17; n >= 3; n -= 2) sum = (1.0 + sum) * (-r2 / (n * (n - 1.0)));
  return r + r * sum;
}

double cos_series(double r) {
  const double r2 = r * r;
  double sum = 0.0;
  for (int n = 18; n >= 2; n -= 2) sum = (1.0 + sum) * (-r2 / (n * (n - 1.0)));
  return 1.0 + sum;
}

}  // namespace

SinCos det_sincos(double angle_rad) {
  const double k = std::floor(angle_rad * (2.0 / kPi) + 0.5);
  const double r = ((angle_rad - k * kHalfPi1) - k * kHalfPi2) - k * kHalfPi3;
  const double s = sin_series(r);
  const double c = cos_series(r);
  switch (static_cast<long long>(k) & 3) {
    case 0:
      return {s, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
}

double det_exp(double x) {
  if (x < -708.0) return 0.0;
  if (x > 709.0) x = 709.0;
  const double k = std::floor(x * (1.0 / (kLn2High + kLn2Low)) + 0.5);
  const double r = (x - k * kLn2High) - k * kLn2Low;
  double sum = 0.0;
  for (int n = 15; n >= 1; --n) sum = (1.0 + sum) * (r / n);
  return std::ldexp(1.0 + sum, static_cast<int>(k));
}

double det_log(double x) {
  constexpr double kSqrtHalf = 0.70710678118654752440;
  int exponent = 0;
  double mantissa = std::frexp(x, &exponent);
  if (mantissa < kSqrtHalf) {
    mantissa *= 2.0;
    --exponent;
  }
  // log m = 2 atanh(s), s = (m - 1) / (m + 1), |s| < 0.172
  const double s = (mantissa - 1.0) / (mantissa + 1.0);
  const double s2 = s * s;
  double sum = 0.0;
  for (int n = 23; n >= 3; n -= 2) sum = s2 * (1.0 / n + sum);
  return exponent * kLn2High + (2.0 * s + (2.0 * s * sum + exponent * kLn2Low));
}

double det_pow(double x, double exponent) {
  if (x <= 0.0) return exponent == 0.0 ? 1.0 : 0.0;
  return det_exp(exponent * det_log(x));
}

}  // namespace berth::host
