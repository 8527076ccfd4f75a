#include "pose/outline_edges.hpp"

#include "fixed/roots.hpp"
#include "fixed/wide.hpp"
#include "pose/outline_profile.hpp"

namespace berth {
namespace {

constexpr std::int64_t kOne16 = std::int64_t{1} << 16;
constexpr std::int32_t kWindowSigmas = q<16>(3.2).raw();
constexpr std::int32_t kMaxReach = q<16>(8.5).raw();  // px across the edge
constexpr std::int32_t kMinNormal = q<16>(0.3).raw();
constexpr std::int32_t kShortStep = q<16>(0.25).raw();
constexpr int kPulseReach = 7 << 12;  // Q<12>: the opposite edge counts when nearer, in sigma

std::int32_t to32(std::int64_t v) { return narrow<std::int32_t>(v); }
std::int64_t times(std::int64_t a, std::int64_t b) { return shift_round(a * b, 16); }  // Q<16>

// The outline between two vertices as a cubic u(m) over scan lines m, all Q<16>.
struct ScanCurve {
  bool rows = true;  // scan lines are image rows
  std::int32_t m0, u0, length;
  std::int32_t slope, second, third;     // of u in (m - m0)
  std::int32_t normal, normal_per_line;  // n_u, linear
  std::int32_t curvature;                // 1/px, white convex > 0
};

// kappa = -dn . dp / |dp|^2 between the vertices. |dp| >= 1/16 px.
bool curvature_of(const OutlineVertex& a, const OutlineVertex& b, std::int32_t& curvature) {
  const std::int64_t dx = b.point_px[0].raw() - a.point_px[0].raw();
  const std::int64_t dy = b.point_px[1].raw() - a.point_px[1].raw();
  const std::int64_t square = dx * dx + dy * dy;  // Q<32>
  if (square < (std::int64_t{1} << 24) || square > (std::int64_t{1} << 46)) return false;
  const std::int64_t bend =
      (b.normal_x.raw() - a.normal_x.raw()) * dx + (b.normal_y.raw() - a.normal_y.raw()) * dy;
  curvature = saturate32(-bend / (square >> 16));
  return curvature < kOne16 && curvature > -kOne16;
}

bool make_scan_curve(const OutlineVertex& a, const OutlineVertex& b, ScanCurve& curve) {
  if (!curvature_of(a, b, curve.curvature)) return false;
  const std::int64_t dx = b.point_px[0].raw() - a.point_px[0].raw();
  const std::int64_t dy = b.point_px[1].raw() - a.point_px[1].raw();
  curve.rows = magnitude(dy) >= magnitude(dx);
  const int m = curve.rows ? 1 : 0;
  const bool swap = a.point_px[m] > b.point_px[m];
  const OutlineVertex& first = swap ? b : a;
  const OutlineVertex& last = swap ? a : b;
  const auto normal = [&](const OutlineVertex& v, int axis) {
    return std::int64_t{axis == 0 ? v.normal_x.raw() : v.normal_y.raw()};
  };
  const std::int64_t n0 = normal(first, 1 - m), n1 = normal(last, 1 - m);
  if (magnitude(n0) < kMinNormal || magnitude(n1) < kMinNormal || (n0 < 0) != (n1 < 0))
    return false;
  curve.m0 = first.point_px[m].raw();
  curve.u0 = first.point_px[1 - m].raw();
  const std::int64_t h = last.point_px[m].raw() - curve.m0;
  curve.length = to32(h);
  if (h < 64) return false;  // no scan line in between, or nearly so
  const std::int64_t chord = ((last.point_px[1 - m].raw() - std::int64_t{curve.u0}) * kOne16) / h;
  curve.normal = to32(n0);
  curve.normal_per_line = to32(((n1 - n0) * kOne16) / h);
  curve.slope = to32(chord);
  curve.second = curve.third = 0;
  if (h < kShortStep) return true;
  // Hermite: slopes of the tangent, perpendicular to the normal, at both ends.
  const std::int64_t q0 = -(normal(first, m) * kOne16) / n0;
  const std::int64_t q1 = -(normal(last, m) * kOne16) / n1;
  curve.slope = to32(q0);
  curve.second = saturate32(((3 * chord - 2 * q0 - q1) * kOne16) / h);
  curve.third = saturate32(((((q0 + q1 - 2 * chord) * kOne16) / h) * kOne16) / h);
  return true;
}

// Slope of a level along the scan line, DN per px Q<8>, from its slope across the marker's plane.
std::int32_t slope_along(const std::int32_t slope[2], const OutlineVertex& v, int axis) {
  const std::int64_t sum = std::int64_t{slope[0]} * v.place_by_px[0][axis].raw() +
                           std::int64_t{slope[1]} * v.place_by_px[1][axis].raw();  // Q<32>
  return saturate32(shift_round(sum, 24));
}

// The model of a segment, ready for its pixels.
struct PixelModel {
  const EdgeProfile* profile;
  std::int32_t x0;                // x at the crossing, Q<12>
  std::int32_t quadratic, cubic;  // of x in e, Q<14>
  std::int32_t one_over_sigma;    // 1/px, Q<16>
  std::int32_t pulse;             // x' = pulse - x, Q<12>; 0: no opposite edge near
  std::int32_t inside, outside;   // reach along the scan line, px Q<16>
  std::int32_t black, contrast;   // DN, Q<8>
  std::int32_t black_per_px, contrast_per_px;
};

bool make_pixel_model(const OutlinePiece& piece, const OutlineVertex& a, const OutlineVertex& b,
                      const SegmentModel& model, const ScanCurve& curve, PixelModel& out,
                      Px& sigma_px) {
  // Normal halfway, Q<16>; |n| <= 1, so that all products below stay under 2^48.
  const std::int64_t nx = (a.normal_x.raw() + b.normal_x.raw()) / 2;
  const std::int64_t ny = (a.normal_y.raw() + b.normal_y.raw()) / 2;
  const std::int64_t nxx = times(nx, nx), nxy = times(nx, ny), nyy = times(ny, ny);
  const ImageBlur& v = model.blur;
  const std::int64_t across =
      times(nxx, v.xx.raw()) + 2 * times(nxy, v.xy.raw()) + times(nyy, v.yy.raw());
  const std::int64_t along = v.xx.raw() + v.yy.raw() - across;
  const std::int64_t bend = times(curve.curvature, along);  // kappa v_t, px
  const std::int64_t widened = across + times(bend, bend) / 2;
  if (across < (1 << 10) || widened > (40 << 16)) return false;
  const std::int64_t sigma = isqrt(static_cast<std::uint64_t>(across) << 16);
  const std::int64_t sigma_e = isqrt(static_cast<std::uint64_t>(widened) << 16);
  const std::int64_t inverse = (std::int64_t{1} << 32) / sigma_e;
  sigma_px = Px::from_wide(sigma);
  out.one_over_sigma = to32(inverse);
  const std::int64_t box = across > model.blur_floor.raw() ? across - model.blur_floor.raw() : 0;
  const std::int64_t shape = (box * kProfileShapes + across / 2) / across;
  out.profile =
      &edge_profile(shape < kProfileShapes ? static_cast<int>(shape) : kProfileShapes - 1);

  // Light that rises across a blurred edge: (L step) * PSF = L P + g^T S n p / s, as if the edge
  // lay g^T S n / C further out, with g the slope of the contrast.
  const std::int64_t gx = slope_along(model.contrast_slope, a, 0);  // DN per px, Q<8>
  const std::int64_t gy = slope_along(model.contrast_slope, a, 1);
  const std::int64_t light = gx * (times(nx, v.xx.raw()) + times(ny, v.xy.raw())) +
                             gy * (times(nx, v.xy.raw()) + times(ny, v.yy.raw()));  // Q<24>
  const std::int64_t lit = (light >> (8 - kLevelFraction)) / model.contrast;        // px Q<16>
  const std::int64_t offset = times(model.edge_offset.raw(), sigma);
  out.x0 = to32(shift_round((offset + lit - bend / 2) * inverse, 20));
  const std::int64_t n_u = curve.rows ? nx : ny;
  const std::int64_t t_uu = kOne16 - times(n_u, n_u);
  const std::int64_t half_bend = times(curve.curvature, t_uu) / 2;
  out.quadratic = saturate32(-shift_round(half_bend * inverse, 18));
  out.cubic = saturate32(-shift_round(times(times(half_bend, curve.curvature), n_u) * inverse, 18));

  const std::int64_t width = (std::int64_t{a.width_px.raw()} + b.width_px.raw()) / 2;
  const std::int64_t other_bend = (1 + piece.opposite_curvature) * (bend / 2);
  const std::int64_t pulse = shift_round((width + 2 * offset - other_bend) * inverse, 20);
  out.pulse = pulse < kPulseReach ? to32(pulse) : 0;
  if (pulse <= 0) return false;

  std::int64_t reach = times(kWindowSigmas, sigma_e) + kOne16 / 2;
  if (reach > kMaxReach) reach = kMaxReach;
  std::int64_t outside = a.outside_px < b.outside_px ? a.outside_px.raw() : b.outside_px.raw();
  // Leave the neighbour its blur, but never less than half of the gap.
  const std::int64_t polite = outside - (5 * sigma_e) / 2;
  outside = polite > outside / 2 ? polite : outside / 2;
  if (outside > reach) outside = reach;
  if (outside < kOne16) return false;
  const std::int64_t inside = width / 2 < reach ? width / 2 : reach;
  const std::int64_t steep = static_cast<std::int64_t>(magnitude(n_u));
  if (steep < kMinNormal) return false;
  constexpr int kFiner = 1 << (8 - kLevelFraction);
  out.black = model.black * kFiner;
  out.contrast = model.contrast * kFiner;
  out.black_per_px = slope_along(model.black_slope, a, curve.rows ? 0 : 1);
  out.contrast_per_px = slope_along(model.contrast_slope, a, curve.rows ? 0 : 1);
  out.inside = to32((inside * kOne16) / steep);
  out.outside = to32((outside * kOne16) / steep);
  return true;
}

// Sums of one station; 32 bits hold them: 25 pixels, |r| <= 2^12.6, P, p <= 2^13.
struct StationSums {
  std::int32_t slope_residual = 0, slope_slope = 0, blur_residual = 0, blur_blur = 0;
  std::int32_t slope = 0, slope_step = 0, step = 0, step_step = 0, blur = 0, blur_step = 0;
  std::int32_t residual = 0, step_residual = 0, square = 0, pixels = 0;
};

StationSums measure_station(const PixelModel& model, const std::uint8_t* pixel, int stride,
                            int count, std::uint8_t polarity, std::int32_t e_q12,
                            std::int32_t linear_q14) {
  StationSums s;
  std::int32_t black = model.black + ((e_q12 * model.black_per_px) >> 12);
  std::int32_t contrast = model.contrast + ((e_q12 * model.contrast_per_px) >> 12);
  s.pixels = count;
  constexpr int kHalf = 1 << (kProfileFraction - 1);
  for (int i = 0; i < count; ++i, pixel += stride, e_q12 += 1 << 12) {  // at most kMaxWindow
    const std::int32_t bent = model.quadratic + ((e_q12 * model.cubic) >> 12);
    const std::int32_t rise = linear_q14 + ((e_q12 * bent) >> 12);
    const auto x =
        static_cast<std::int32_t>(model.x0 + shift_round(std::int64_t{e_q12} * rise, 14));
    ProfileValue p = look_up(*model.profile, x);
    std::int32_t h = (p.slope * x) >> 12;
    if (model.pulse != 0) {
      const ProfileValue other = look_up(*model.profile, model.pulse - x);
      p.step += other.step - (1 << kProfileFraction);
      p.slope -= other.slope;
      h += (other.slope * (model.pulse - x)) >> 12;
    }
    const std::int32_t grey = (*pixel ^ polarity) << kLevelFraction;
    const std::int32_t r =
        grey - ((black + ((contrast * p.step + kHalf) >> kProfileFraction) + 8) >> 4);
    black += model.black_per_px;
    contrast += model.contrast_per_px;
    s.slope_residual += p.slope * r;
    s.slope_slope += p.slope * p.slope;
    s.blur_residual += h * r;
    s.blur_blur += h * h;
    s.blur += h;
    s.blur_step += (h * p.step + kHalf) >> kProfileFraction;
    s.slope += p.slope;
    s.slope_step += (p.slope * p.step + kHalf) >> kProfileFraction;
    s.step += p.step;
    s.step_step += (p.step * p.step + kHalf) >> kProfileFraction;
    s.residual += r;
    s.step_residual += p.step * r;
    s.square += r * r;
  }
  return s;
}

// Full weight up to four times the ordinary mean square, then falling with its square.
std::int32_t robust_weight(const StationSums& s, const SegmentModel& model) {
  if (model.ordinary_q8 == 0) return kFullWeight;
  const std::int64_t limit = std::int64_t{4} * model.ordinary_q8 * s.pixels;
  std::int32_t weight = kFullWeight;
  if (s.square > limit) {
    const auto ratio = static_cast<std::int32_t>((limit << 4) / s.square);  // < 16
    weight = (ratio * ratio) >> 4;
  }
  if (model.judge_shift) {
    // (p r)^2 / (p p) is the square that a shift explains: above 12 sigma^2 it is no noise.
    const std::int64_t shift = std::int64_t{s.slope_residual} * s.slope_residual;     // Q<34>
    const std::int64_t bound = std::int64_t{12} * model.ordinary_q8 * s.slope_slope;  // Q<34>
    if (shift > 4 * bound) return 0;
    if (shift > bound) weight /= 4;
  }
  return weight;
}

void add_station(const StationSums& s, std::int32_t weight, SegmentSums& sums) {
  const std::int64_t w = weight;
  sums.slope_residual += w * s.slope_residual;
  sums.slope_slope += w * s.slope_slope;
  sums.blur_residual += w * s.blur_residual;
  sums.blur_blur += w * s.blur_blur;
  sums.slope += w * s.slope;
  sums.blur += w * s.blur;
  sums.blur_step += w * s.blur_step;
  sums.slope_step += w * s.slope_step;
  sums.step += w * s.step;
  sums.step_step += w * s.step_step;
  sums.residual += w * s.residual;
  sums.step_residual += w * s.step_residual;
  sums.square += w * s.square;
  sums.pixels += weight * s.pixels;
}

}  // namespace

void ResidualHistogram::add(std::uint32_t mean_square_q8) {
  const std::uint32_t v = mean_square_q8 < 16 ? 16 : mean_square_q8;
  const int octave = 31 - leading_zeros32(v);  // >= 4
  const int fraction = static_cast<int>((v >> (octave - 3)) & 7);
  const int index = (octave - 4) * 8 + fraction;
  ++count[index < kClasses ? index : kClasses - 1];
  ++total;
}

std::int32_t ResidualHistogram::median_q8() const {
  std::int32_t seen = 0;
  for (int i = 0; i < kClasses; ++i) {
    seen += count[i];
    if (2 * seen >= total && seen > 0) {
      const std::int64_t middle = std::int64_t{2 * (8 + i % 8) + 1}
                                  << (i / 8);  // (8 + f + 1/2) 2^(o-3)
      return saturate32(middle);
    }
  }
  return 0;
}

void measure_segment(const ImageView& image, const OutlinePiece& piece, const OutlineVertex& a,
                     const OutlineVertex& b, const SegmentModel& model, SegmentSums& sums,
                     ResidualHistogram& histogram) {
  sums = SegmentSums{};
  ScanCurve curve;
  PixelModel pixels;
  if (!a.visible || !b.visible || !make_scan_curve(a, b, curve)) return;
  if (!make_pixel_model(piece, a, b, model, curve, pixels, sums.sigma_px)) return;
  const int lines = curve.rows ? image.height : image.width;
  const int places = curve.rows ? image.width : image.height;
  std::int64_t first = (std::int64_t{curve.m0} + kOne16 - 1) >> 16;
  std::int64_t end = (std::int64_t{curve.m0} + curve.length + kOne16 - 1) >> 16;
  if (first < 0) first = 0;
  if (end > lines) end = lines;
  const bool white_ahead = curve.normal > 0;
  for (std::int64_t m = first; m < end; ++m) {  // at most the image's side
    if ((m & (model.stride - 1)) != 0) continue;
    const std::int64_t tau = (m << 16) - curve.m0;
    const std::int64_t u =
        curve.u0 + times(tau, curve.slope + times(tau, curve.second + times(tau, curve.third)));
    const std::int64_t n_u = curve.normal + times(tau, curve.normal_per_line);
    const std::int64_t begin =
        (u - (white_ahead ? pixels.outside : pixels.inside) + kOne16 - 1) >> 16;
    const std::int64_t last = (u + (white_ahead ? pixels.inside : pixels.outside)) >> 16;
    if (begin < 0 || last >= places || last - begin >= kMaxWindow || last - begin < 2) continue;
    const auto e = to32(shift_round((begin << 16) - u, 4));
    const auto linear = to32(shift_round(n_u * pixels.one_over_sigma, 18));
    const auto line = static_cast<int>(m), place = static_cast<int>(begin);
    const std::uint8_t* start = curve.rows ? image.pixels + line * image.stride + place
                                           : image.pixels + place * image.stride + line;
    const StationSums s =
        measure_station(pixels, start, curve.rows ? 1 : image.stride,
                        static_cast<int>(last - begin + 1), image.polarity_mask, e, linear);
    histogram.add(static_cast<std::uint32_t>(s.square) / static_cast<std::uint32_t>(s.pixels));
    const std::int32_t weight = robust_weight(s, model);
    ++sums.stations;
    if (weight < kFullWeight / 4) ++sums.rejected;
    add_station(s, weight, sums);
  }
}

}  // namespace berth
