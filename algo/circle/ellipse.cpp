#include "circle/ellipse.hpp"

#include "fixed/roots.hpp"

namespace berth {
namespace {

using Conic = Q<24>;  // coefficients of the conic in its own frame: near 0 or 1, |.| < 16 accepted

struct Symmetric2 {
  Conic a, b, c;  // [a b; b c]
};

// Upper Cholesky factor U of s, s = U^T U. False when s is not clearly positive definite. |s| <=
// 120.
bool cholesky(const Symmetric2& s, Q<24> (&u)[3]) {
  constexpr Conic kLeast = q<24>(0.02);
  if (s.a < kLeast || s.c < kLeast) return false;
  u[0] = sqrt<24>(s.a);
  if (abs(s.b) >= Conic(11) * u[0]) return false;  // b^2 / a >= 121 > c
  u[1] = div<24>(s.b, u[0]);
  const Conic rest = s.c - u[1] * u[1];
  if (rest < kLeast) return false;
  u[2] = sqrt<24>(rest);
  return true;
}

// Products of two stay below 128.
constexpr bool is_moderate(Conic v) { return v > Conic(-11) && v < Conic(11); }

}  // namespace

Ellipse Ellipse::circle(Px x, Px y, Px radius) {
  Ellipse e;
  e.cx = x;
  e.cy = y;
  e.m[0][0] = e.m[1][1] = div<26>(Px(1), radius);
  return e;
}

EllipseFrame::EllipseFrame(const Ellipse& e)
    : cx(e.cx.to<6>().raw()),
      cy(e.cy.to<6>().raw()),
      m{{e.m[0][0].to<16>().raw(), e.m[0][1].to<16>().raw()},
        {e.m[1][0].to<16>().raw(), e.m[1][1].to<16>().raw()}} {}

namespace {

// Inverse of M, cells: false when singular or larger than `limit` cells.
bool invert(const Ellipse& e, Px limit, Px (&inverse)[2][2]) {
  const std::int64_t det = (std::int64_t{e.m[0][0].raw()} * e.m[1][1].raw() -
                            std::int64_t{e.m[0][1].raw()} * e.m[1][0].raw());  // Q52
  const std::int64_t least = std::int64_t{1} << 30;
  if (det < least && det > -least) return false;
  const std::int64_t d = shift_round(det, 10);  // Q42
  const std::int32_t adjugate[2][2] = {{e.m[1][1].raw(), -e.m[0][1].raw()},
                                       {-e.m[1][0].raw(), e.m[0][0].raw()}};
  for (int i = 0; i < 2; ++i) {
    for (int k = 0; k < 2; ++k) {
      const std::int64_t v = adjugate[i][k] * (std::int64_t{1} << 32) / d;  // Q58 / Q42 = Q16
      if (v > limit.raw() || v < -limit.raw()) return false;
      inverse[i][k] = Px::from_wide(v);
    }
  }
  return true;
}

}  // namespace

bool measure_axes(const Ellipse& e, Px limit, EllipseAxes& axes) {
  Px w[2][2];
  if (!invert(e, limit, w)) return false;
  axes.half_width = Px::from_wide(hypot(w[0][0].raw(), w[0][1].raw()));
  axes.half_height = Px::from_wide(hypot(w[1][0].raw(), w[1][1].raw()));
  // Semi-axes are the singular values s1 >= s2 of W: s1 +- s2 by the sums of a 2 x 2 matrix.
  const std::uint32_t plus = hypot((w[0][0] + w[1][1]).raw(), (w[0][1] - w[1][0]).raw());
  const std::uint32_t minus = hypot((w[0][0] - w[1][1]).raw(), (w[0][1] + w[1][0]).raw());
  const std::uint32_t high = plus > minus ? plus : minus, low = plus > minus ? minus : plus;
  axes.major = Px::from_wide((std::int64_t{high} + low) / 2);
  axes.minor = Px::from_wide((std::int64_t{high} - low) / 2);
  return axes.major <= limit && axes.minor.raw() > 0;
}

EllipsePoint point_at(const Ellipse& e, Unit cosine, Unit sine) {
  Px w[2][2];
  if (!invert(e, Px(4096), w)) return {e.cx, e.cy};
  return {e.cx + w[0][0] * cosine + w[0][1] * sine, e.cy + w[1][0] * cosine + w[1][1] * sine};
}

bool EllipseFit::solve(const EllipseFrame& frame, Ellipse& ellipse) {
  std::int32_t solution[kConicTerms];
  if (count() < 8 || !system_.solve(solution)) return false;
  Conic k[kConicTerms];
  for (int i = 0; i < kConicTerms; ++i) {
    k[i] = Conic::from_raw(solution[i]);
    if (!is_moderate(k[i])) return false;
  }
  // Centre q0 = -[2A B; B 2C]^-1 [D E], value there 1 + (A x0^2 + B x0 y0 + C y0^2).
  const Conic a = k[0], b = Conic::from_raw(k[1].raw() / 2), c = k[2];
  if (a.raw() <= 0 || c.raw() <= 0) return false;
  const Conic det = a * c - b * b;
  if (det < q<24>(0.02)) return false;
  const Conic d = Conic::from_raw(k[3].raw() / 2), e = Conic::from_raw(k[4].raw() / 2);
  const Q<24> x0 = Q<24>::saturated(shift_by((b * e - c * d).raw(), 24) / det.raw());
  const Q<24> y0 = Q<24>::saturated(shift_by((b * d - a * e).raw(), 24) / det.raw());
  // Farther than the frame can jump. No abs() here: the least value has none.
  constexpr Q<24> kFar(1);
  if (x0 > kFar || x0 < -kFar || y0 > kFar || y0 < -kFar) return false;
  const Conic value = Conic(1) + a * x0 * x0 + b * x0 * y0 * Conic(2) + c * y0 * y0;
  if (value < q<24>(0.1) || value > Conic(16)) return false;
  Q<24> u[3];
  if (!cholesky({div<24>(a, value), div<24>(b, value), div<24>(c, value)}, u)) return false;

  Ellipse old;
  old.cx = Px::from_wide(std::int64_t{frame.cx} * 1024);
  old.cy = Px::from_wide(std::int64_t{frame.cy} * 1024);
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) old.m[i][j] = Q<26>::from_wide(std::int64_t{frame.m[i][j]} * 1024);
  }
  Px w[2][2];
  if (!invert(old, Px(4096), w)) return false;
  ellipse.cx = old.cx + w[0][0] * x0 + w[0][1] * y0;
  ellipse.cy = old.cy + w[1][0] * x0 + w[1][1] * y0;
  for (int j = 0; j < 2; ++j) {
    ellipse.m[0][j] = mul<26>(u[0], old.m[0][j]) + mul<26>(u[1], old.m[1][j]);
    ellipse.m[1][j] = mul<26>(u[2], old.m[1][j]);
  }
  return true;
}

}  // namespace berth
