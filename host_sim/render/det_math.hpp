// Elementary functions with the same bits on every machine: built from + - * / and exact scalings,
// since a C library's sin or exp may differ in the last bit from another's. Errors are a few units
// in the last place; the tests bound them against the C library.
#pragma once

namespace berth::host {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kRadPerDeg = kPi / 180.0;

/// Sine and cosine of the same angle; |angle| up to 1e5 rad.
struct SinCos {
  double sin;
  double cos;
};
SinCos det_sincos(double angle_rad);

/// e^x; 0 below -708 and saturated at x = 709.
double det_exp(double x);

/// Natural logarithm of a positive normal number.
double det_log(double x);

/// x^exponent for x >= 0.
double det_pow(double x, double exponent);

}  // namespace berth::host
