// See trigonometry.hpp.
#include "fixed/trigonometry.hpp"

#include "fixed/roots.hpp"
#include "fixed/wide.hpp"

namespace berth {
namespace {

constexpr std::int64_t kOne = std::int64_t{1} << 30;

// Product of two numbers of 30 fraction bits; |result| < 2^31 at every use below.
constexpr std::int32_t mul30(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(shift_round(std::int64_t{a} * b, 30));
}
constexpr std::int32_t q30(double value) { return q<30>(value).raw(); }

// c + s p with 31 fraction bits, |s p| < 1/2; polynomials hold twice the value, so that the upper
// half of a product is what mul31 gives.
constexpr std::int32_t twice(double value) { return q<31>(value).raw() * 2; }
inline std::int32_t horner(std::int32_t twice_c, std::int32_t s, std::int32_t twice_p) {
  return twice_c + 2 * multiply_high(s, twice_p);
}

// sin(r) and cos(r) - 1, |r| <= pi/4 + 2^-29, with 31 fraction bits to keep the rounding small.
// s = r^2, at most 0.617.
inline std::int32_t sin_polynomial(std::int32_t r, std::int32_t s) {
  std::int32_t p = twice(-1.0 / 39916800.0);
  p = horner(twice(1.0 / 362880.0), s, p);
  p = horner(twice(-1.0 / 5040.0), s, p);
  p = horner(twice(1.0 / 120.0), s, p);
  p = horner(twice(-1.0 / 6.0), s, p);
  return r + multiply_high(r, 2 * multiply_high(s, p));
}

inline std::int32_t cos_polynomial(std::int32_t s) {
  std::int32_t p = twice(-1.0 / 3628800.0);
  p = horner(twice(1.0 / 40320.0), s, p);
  p = horner(twice(-1.0 / 720.0), s, p);
  p = horner(twice(1.0 / 24.0), s, p);
  p = horner(twice(-1.0 / 2.0), s, p);
  return multiply_high(s, p);
}

// atan(k / 8), k = 0..8, 30 fraction bits.
constexpr std::int32_t kAtanEighths[9] = {
    q30(0.0),
    q30(0.12435499454676143503),
    q30(0.24497866312686415417),
    q30(0.35877067027057222039),
    q30(0.46364760900080611621),
    q30(0.55859931534356243597),
    q30(0.64350110879328438680),
    q30(0.71882999962162450541),
    q30(0.78539816339744830962),
};

// atan(t), |t| <= 1/15: the next term of the series is below 2^-38.
std::int32_t atan_series(std::int32_t t) {
  const std::int32_t s = mul30(t, t);
  std::int32_t p = q30(-1.0 / 7.0);
  p = q30(1.0 / 5.0) + mul30(s, p);
  p = q30(-1.0 / 3.0) + mul30(s, p);
  return t + mul30(t, mul30(s, p));
}

// atan(low / high) with 30 fraction bits; 0 <= low <= high, high > 0.
std::int64_t atan_octant(std::int64_t low, std::int64_t high) {
  const std::int64_t k = (8 * low + high / 2) / high;  // nearest eighth, 0..8
  // atan(l/h) - atan(k/8) = atan((8 l - k h) / (8 h + k l)); |numerator| <= h/2 + 8 <= 2^30 + 8.
  const std::int64_t numerator = (8 * low - k * high) * kOne;
  const std::int64_t denominator = 8 * high + k * low;  // at most 2^35
  const std::int64_t half = numerator < 0 ? -denominator / 2 : denominator / 2;
  const auto t = static_cast<std::int32_t>((numerator + half) / denominator);
  return std::int64_t{kAtanEighths[k]} + atan_series(t);
}

}  // namespace

SinCos sin_cos(Angle angle) {
  // Quadrant: nearest multiple of pi/2. |angle| 2/pi < 5.1, the product is below 2^61.
  const std::int32_t raw = angle.raw();
  const auto quadrant =
      static_cast<std::int32_t>(shift_round(std::int64_t{raw} * q30(0.63661977236758134308), 58));
  // Remainder with 31 fraction bits, |r| < 0.7854 2^31; quadrant pi/2 is below 2^59.
  constexpr std::int64_t kHalfPi56 = 0x1921fb54442d1847 >> 4;
  constexpr auto kLower = static_cast<std::int32_t>(kHalfPi56);
  constexpr auto kUpper = static_cast<std::int32_t>((kHalfPi56 - kLower) >> 32);
  const std::int64_t turned =
      std::int64_t{quadrant} * kLower + std::int64_t{quadrant} * kUpper * (std::int64_t{1} << 32);
  // Of the difference only the lower half counts.
  const std::uint32_t r_bits =
      static_cast<std::uint32_t>(raw) * 8 - static_cast<std::uint32_t>(shift_round(turned, 25));
  const auto r = static_cast<std::int32_t>(r_bits);
  const auto r2 = static_cast<std::int32_t>(shift_round(std::int64_t{r} * r, 31));
  std::int32_t s = (sin_polynomial(r, r2) + 1) >> 1;
  std::int32_t c = (1 << 30) + ((cos_polynomial(r2) + 1) >> 1);
  if ((quadrant & 1) != 0) {
    const std::int32_t keep = s;
    s = c;
    c = -keep;
  }
  if ((quadrant & 2) != 0) s = -s, c = -c;
  return {Unit::from_raw(s), Unit::from_raw(c)};
}

Angle atan2(std::int32_t y, std::int32_t x) {
  constexpr std::int64_t kPi30 = 0xc90fdaa2;
  constexpr std::int64_t kHalfPi30 = 0x6487ed51;
  const std::int64_t ax = x < 0 ? -std::int64_t{x} : x;
  const std::int64_t ay = y < 0 ? -std::int64_t{y} : y;
  if (ax == 0 && ay == 0) return Angle(0);
  std::int64_t a = ay <= ax ? atan_octant(ay, ax) : kHalfPi30 - atan_octant(ax, ay);
  if (x < 0) a = kPi30 - a;
  return Angle::from_wide(shift_round(y < 0 ? -a : a, 2));
}

Angle asin(Unit value) {
  const std::int64_t s = value.raw();
  if (s >= kOne) return kHalfPi;
  if (s <= -kOne) return -kHalfPi;
  const auto c = isqrt_nearest(static_cast<std::uint64_t>((kOne - s) * (kOne + s)));
  return atan2(value.raw(), static_cast<std::int32_t>(c));
}

Angle acos(Unit value) {
  const std::int64_t c = value.raw();
  if (c >= kOne) return Angle(0);
  if (c <= -kOne) return kPi;
  const auto s = isqrt_nearest(static_cast<std::uint64_t>((kOne - c) * (kOne + c)));
  return atan2(static_cast<std::int32_t>(s), value.raw());
}

}  // namespace berth
