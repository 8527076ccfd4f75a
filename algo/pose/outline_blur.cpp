#include "pose/outline_blur.hpp"

#include "fixed/linear.hpp"
#include "fixed/roots.hpp"
#include "fixed/wide.hpp"

namespace berth {
namespace {

constexpr std::int64_t kMinEigenvalue = q<16>(0.2).raw();
constexpr std::int64_t kMaxHalfTrace = q<16>(6.0).raw();
constexpr std::int64_t kSmallShare = 4, kSlightShare = 10;

// S = mean 1 + (dx, xy; xy, -dx)
struct Spread {
  std::int64_t mean, dx, xy, deviation;  // Q<16>; deviation = hypot(dx, xy)
};

Spread spread_of(std::int64_t xx, std::int64_t xy, std::int64_t yy) {
  Spread s;
  s.mean = (xx + yy) / 2;
  s.dx = (xx - yy) / 2;
  s.xy = xy;
  s.deviation = hypot(saturate32(s.dx), saturate32(s.xy));
  return s;
}

std::int64_t distance(Q<16> a, Q<16> b) {
  const std::int64_t d = std::int64_t{a.raw()} - b.raw();
  return d < 0 ? -d : d;
}

std::int64_t change_of(const ImageBlur& a, const ImageBlur& b) {
  return distance(a.xx, b.xx) + 2 * distance(a.xy, b.xy) + distance(a.yy, b.yy);
}

}  // namespace

void add_blur(const SegmentSums& segment, const OutlineMiddle& middle, std::int32_t contrast,
              SectorBlur& sector) {
  if (segment.pixels == 0) return;
  const std::int32_t s = raised(segment.sigma_px.raw(), 12);  // Q<28>, below 6.4
  const auto variance = static_cast<std::uint32_t>(lowered(multiply_high(s, s), 8));  // Q<16>
  const auto steep = static_cast<std::int32_t>((static_cast<std::uint32_t>(contrast) << 15) /
                                               variance);  // C / 2v, Q<4>, < 2^17
  const std::int64_t steep_square = std::int64_t{steep} * steep;
  const std::int32_t weight = saturate32(
      shift_round(shift_round(steep_square, 4) * saturate32(segment.blur_blur >> 12), 18));  // Q<4>
  const std::int32_t pull = saturate32(-shift_round(steep * segment.blur_residual, 17));     // Q<8>
  const std::int32_t nx = raised(middle.normal_x.raw(), 14);  // Q<30>
  const std::int32_t ny = raised(middle.normal_y.raw(), 14);
  const std::int32_t eta[3] = {lowered(multiply_high(nx, nx), 18),
                               lowered(multiply_high(nx, ny), 17),
                               lowered(multiply_high(ny, ny), 18)};                   // Q<10>
  const std::int32_t black = saturate32(-shift_round(steep * segment.blur, 9));       // Q<12>
  const std::int32_t white = saturate32(-shift_round(steep * segment.blur_step, 9));  // Q<12>
  for (int i = 0; i < 3; ++i) {
    const std::int32_t raised_eta = raised(eta[i], 12);
    for (int k = 0; k <= i; ++k) {
      add_product(sector.normal.matrix[i][k], eta[i] * eta[k] * (1 << 4), weight);
    }
    add_product(sector.normal.vector[i], raised_eta, pull);  // Q<30>
    add_product(sector.by_black[i], eta[i], black);
    add_product(sector.by_contrast[i], eta[i], white);
  }
}

void add_sector_blur(const SectorBlur& blur, const LevelBasis& basis, BlurNormal& normal) {
  std::int32_t u[3], v[3];  // Q<14>, the matrix being Q<28>
  for (int i = 0; i < 3; ++i) {
    basis.project(blur.by_black[i] * (1 << 3), blur.by_contrast[i] * (1 << 3), u[i], v[i]);
    for (int k = 0; k <= i; ++k) {
      std::int64_t& term = normal.matrix[i][k];
      term += blur.normal.matrix[i][k];
      add_product(term, u[k], -u[i]);
      add_product(term, v[k], -v[i]);
    }
    // u Q<14>, levels Q<10>: to Q<30>
    normal.vector[i] +=
        blur.normal.vector[i] -
        (std::int64_t{u[i]} * basis.black + std::int64_t{v[i]} * basis.white) * (1 << 6);
  }
}

BlurChange update_blur(const BlurNormal& normal, std::int64_t& growth, ImageBlur& blur) {
  SpdSystem<3> system;
  std::int64_t change[3];
  if (!system.factor(normal.matrix) || !system.solve(normal.vector, change, 14)) {
    return {true, true};
  }
  const std::int64_t trace = std::int64_t{blur.xx.raw()} + blur.yy.raw();
  const bool swings_back = (change[0] + change[2] > 0) != (growth > 0) && growth != 0;
  growth = change[0] + change[2];
  for (std::int64_t& c : change) {
    if (c > 2 * trace) c = 2 * trace;
    if (c < -trace) c = -trace;
    if (swings_back) c /= 2;
  }
  Spread s =
      spread_of(blur.xx.raw() + change[0], blur.xy.raw() + change[1], blur.yy.raw() + change[2]);
  // A third to three times what it was.
  if (s.mean < trace / 6) s.mean = trace / 6;
  if (s.mean > trace + trace / 2) s.mean = trace + trace / 2;
  if (s.mean < kMinEigenvalue) s.mean = kMinEigenvalue;
  if (s.mean > kMaxHalfTrace) s.mean = kMaxHalfTrace;
  // A quarter of the smaller eigenvalue: profiles too sharp are slow to widen, they see no tails.
  const std::int64_t quarter = blur_floor(blur).raw() / 4;
  const std::int64_t limit = s.mean - (quarter > kMinEigenvalue ? quarter : kMinEigenvalue);
  if (s.deviation > limit) {
    s.dx = s.dx * limit / s.deviation;
    s.xy = s.xy * limit / s.deviation;
  }
  const ImageBlur before = blur;
  blur.xx = Q<16>::from_wide(s.mean + s.dx);
  blur.yy = Q<16>::from_wide(s.mean - s.dx);
  blur.xy = Q<16>::from_wide(s.xy);
  const std::int64_t changed = change_of(before, blur);  // twice the variance, where it is round
  return {kSmallShare * changed < trace, kSlightShare * changed < 2 * blur_floor(blur).raw()};
}

ImageBlur round_blur(std::int64_t variance) {
  if (variance < kMinEigenvalue) variance = kMinEigenvalue;
  if (variance > kMaxHalfTrace) variance = kMaxHalfTrace;
  ImageBlur blur;
  blur.xx = blur.yy = Q<16>::from_wide(variance);
  return blur;
}

Q<16> blur_floor(const ImageBlur& blur) {
  const Spread s = spread_of(blur.xx.raw(), blur.xy.raw(), blur.yy.raw());
  const std::int64_t floor = s.mean - s.deviation;
  return Q<16>::from_wide(floor > kMinEigenvalue ? floor : kMinEigenvalue);
}

}  // namespace berth
