#include "pose/outline_segment.hpp"

#include "fixed/roots.hpp"
#include "fixed/wide.hpp"

namespace berth {
namespace {

constexpr std::int64_t kOne16 = std::int64_t{1} << 16;
constexpr std::int32_t kWindowSigmas = q<16>(3.2).raw();
constexpr std::int32_t kMaxReach = q<16>(8.5).raw();  // px across the edge
constexpr std::int32_t kMinNormal = q<16>(0.3).raw();
constexpr std::int32_t kShortStep = q<16>(0.25).raw();
constexpr std::int32_t kLeastSkew = 8;  // Q<13>: 0.0004 of the contrast at most
constexpr int kPulseReach = 7 << 12;    // Q<12>: the opposite edge counts when nearer, in sigma

std::int32_t to32(std::int64_t v) { return narrow<std::int32_t>(v); }
std::int64_t times(std::int64_t a, std::int64_t b) { return shift_round(a * b, 16); }  // Q<16>

// Nearest to a / b, b != 0.
std::int64_t divide_round(std::int64_t a, std::int64_t b) {
  const std::int64_t half = static_cast<std::int64_t>(magnitude(b) / 2);
  return (a < 0 ? a - half : a + half) / b;
}

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

// What a cubic misses of a circle's arc on the mean over the segment, px Q<16>: the next term is
// u s^2 (1 - s)^2 h^4 / 24 with u = 3 kappa^2 u'' (1 + q^2)(1 + 5 q^2), q the slope; its
// mean is (kappa h)^2 h^2 u'' (1 + q^2)(1 + 5 q^2) / 240. Up to 0.0005 px on the largest ring.
std::int64_t mean_beyond_cubic(const ScanCurve& curve) {
  const std::int64_t turn = times(curve.curvature, curve.length);
  const std::int64_t sagitta =  // h^2 u'' halfway
      shift_round((2 * std::int64_t{curve.second} + 3 * std::int64_t{curve.third}) * curve.length,
                  20);
  const std::int64_t q = shift_round(
      4 * (std::int64_t{curve.first} + curve.second) + 3 * std::int64_t{curve.third}, 6);
  const std::int64_t q2 = times(q, q);
  const std::int64_t steepness = times(kOne16 + q2, kOne16 + 5 * q2);
  return times(times(times(turn, turn), sagitta), steepness) / 240;
}

}  // namespace

bool make_scan_curve(const OutlineVertex& a, const OutlineVertex& b, ScanCurve& curve) {
  if (!curvature_of(a, b, curve.curvature)) return false;
  const std::int64_t dx = b.point_px[0].raw() - a.point_px[0].raw();
  const std::int64_t dy = b.point_px[1].raw() - a.point_px[1].raw();
  curve.rows = magnitude(dy) >= magnitude(dx);
  const int m = curve.rows ? 1 : 0;
  const bool swap = a.point_px[m] > b.point_px[m];
  curve.swapped = swap;
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
  if (h <= (1 << 11)) return false;  // hardly a scan line in between
  const std::int64_t wedge = static_cast<std::int64_t>(magnitude(n0)) -
                             static_cast<std::int64_t>(magnitude(normal(first, m)));
  curve.wedge = to32(wedge);
  curve.wedge_gain = to32(static_cast<std::int64_t>(magnitude(n1)) -
                          static_cast<std::int64_t>(magnitude(normal(last, m))) - wedge);
  curve.per_length = to32((std::int64_t{1} << 42) / h);  // h > 2^11: below 2^31
  const std::int64_t chord =
      divide_round((last.point_px[1 - m].raw() - std::int64_t{curve.u0}) * (1 << 20), h);
  curve.normal = to32(n0);
  curve.normal_gain = to32(n1 - n0);
  curve.first = to32(chord);
  curve.second = curve.third = 0;
  if (h < kShortStep) return true;
  // Hermite: slopes of the tangent, perpendicular to the normal, at both ends.
  const std::int64_t q0 = -divide_round(normal(first, m) * (1 << 20), n0);
  const std::int64_t q1 = -divide_round(normal(last, m) * (1 << 20), n1);
  curve.first = to32(q0);
  curve.second = to32(3 * chord - 2 * q0 - q1);
  curve.third = to32(q0 + q1 - 2 * chord);
  curve.u0 = to32(curve.u0 + mean_beyond_cubic(curve));
  return true;
}

namespace {

// Slope of a level along the scan line, DN per px Q<8>, from its slope across the marker's plane.
std::int32_t slope_along(const std::int32_t slope[2], const OutlineVertex& v, int axis) {
  const std::int64_t sum = std::int64_t{slope[0]} * v.place_by_px[0][axis].raw() +
                           std::int64_t{slope[1]} * v.place_by_px[1][axis].raw();  // Q<32>
  return saturate32(shift_round(sum, 24));
}

// n^T S n at a vertex, px^2 Q<16>.
std::int64_t variance_across(const ImageBlur& v, const OutlineVertex& p) {
  const std::int64_t nx = p.normal_x.raw(), ny = p.normal_y.raw();
  return times(times(nx, nx), v.xx.raw()) + 2 * times(times(nx, ny), v.xy.raw()) +
         times(times(ny, ny), v.yy.raw());
}

// Blur beside a segment, px^2 Q<16>; n, t: normal and tangent halfway, |n| <= 1, so that all
// products stay under 2^48.
struct LocalBlur {
  std::int64_t nx = 0, ny = 0, cos_2 = 0, sin_2 = 0;  // Q<16>
  std::int64_t across = 0, along = 0, oblique = 0;    // n^T S n, t^T S t, n^T S t
  std::int64_t box = 0, moved = 0;                    // what of across and along is motion
  std::int64_t turned = 0;                            // what across gains from a to b
  std::int64_t sigma = 0, inverse = 0;                // px; 1/px, widened by the curve
};

bool make_local_blur(const OutlineVertex& a, const OutlineVertex& b, const SegmentModel& model,
                     std::int32_t curvature, LocalBlur& out) {
  const ImageBlur& v = model.blur;
  out.nx = (a.normal_x.raw() + b.normal_x.raw()) / 2;
  out.ny = (a.normal_y.raw() + b.normal_y.raw()) / 2;
  const std::int64_t nxx = times(out.nx, out.nx), nxy = times(out.nx, out.ny);
  const std::int64_t nyy = times(out.ny, out.ny);
  out.cos_2 = nxx - nyy;
  out.sin_2 = 2 * nxy;
  out.across = times(nxx, v.xx.raw()) + 2 * times(nxy, v.xy.raw()) + times(nyy, v.yy.raw());
  out.along = v.xx.raw() + v.yy.raw() - out.across;
  out.oblique = times(out.cos_2, v.xy.raw()) - times(nxy, v.xx.raw() - v.yy.raw());
  out.turned = variance_across(v, b) - variance_across(v, a);
  const std::int64_t floor = model.blur_floor.raw();
  out.box = out.across > floor ? out.across - floor : 0;
  out.moved = out.along > floor ? out.along - floor : 0;
  // Var(t^2) is 2 v^2 for a Gaussian, 0.8 v^2 for the box of motion.
  const std::int64_t bend = times(curvature, out.along), moved = times(curvature, out.moved);
  const std::int64_t widened = out.across + times(bend, bend) / 2 - (3 * times(moved, moved)) / 10;
  if (out.across < (1 << 10) || widened < (1 << 10) || widened > (40 << 16)) return false;
  out.sigma = isqrt(static_cast<std::uint64_t>(out.across) << 16);
  out.inverse = (std::int64_t{1} << 32) / isqrt(static_cast<std::uint64_t>(widened) << 16);
  return true;
}

// Light that rises across a blurred edge: (L step) * PSF = L P + g^T S n p / s, as if the edge lay
// g^T S n / C further out, with g the slope of the contrast. px Q<16>.
std::int64_t shift_by_light(const OutlineVertex& a, const SegmentModel& model,
                            const LocalBlur& blur) {
  const ImageBlur& v = model.blur;
  const std::int64_t gx = slope_along(model.contrast_slope, a, 0);  // DN per px, Q<8>
  const std::int64_t gy = slope_along(model.contrast_slope, a, 1);
  const std::int64_t light =
      gx * (times(blur.nx, v.xx.raw()) + times(blur.ny, v.xy.raw())) +
      gy * (times(blur.nx, v.xy.raw()) + times(blur.ny, v.yy.raw()));  // Q<24>
  return (light >> (8 - kLevelFraction)) / model.contrast;
}

// x at the crossing, the opposite edge, and how both change along the segment. False where nothing
// is left between the edges.
bool set_place(const OutlinePiece& piece, std::int64_t width, std::int64_t lit,
               const SegmentModel& model, const LocalBlur& blur, std::int32_t curvature,
               PixelModel& out) {
  const std::int64_t inverse = blur.inverse;
  const std::int64_t bend = times(curvature, blur.along);  // kappa v_t, px
  const std::int64_t offset = times(model.edge_offset.along(blur.cos_2, blur.sin_2), blur.sigma);
  const std::int64_t other_bend = (1 + piece.opposite_curvature) * (bend / 2);
  const std::int64_t pulse = shift_round((width + 2 * offset - other_bend) * inverse, 20);
  if (pulse <= 0) return false;
  out.x0 = to32(shift_round((offset + lit - bend / 2) * inverse, 20));
  out.pulse = pulse < kPulseReach ? to32(pulse) : 0;
  // 1/s loses half of what v_n gains; v_t loses what v_n gains.
  const std::int64_t gain = -(blur.turned * (1 << 15)) / blur.across;
  const std::int64_t bend_gain = shift_round(times(curvature, blur.turned) * inverse, 21);
  out.one_over_sigma = to32(inverse);
  out.one_over_sigma_gain = to32(times(inverse, gain));
  out.x0_gain = to32(times(out.x0, gain) + bend_gain);
  out.pulse_gain = to32(times(out.pulse, gain) + (1 + piece.opposite_curvature) * bend_gain);
  return true;
}

void set_shape(const LocalBlur& blur, const ScanCurve& curve, PixelModel& out) {
  const std::int64_t shape = (blur.box * kProfileShapes + blur.across / 2) / blur.across;
  out.profile =
      &edge_profile(shape < kProfileShapes ? static_cast<int>(shape) : kProfileShapes - 1);
  // 1.2 kappa c^2 / (6 s^3), and what its next order adds for the smallest dots.
  const std::int64_t bent = times(curve.curvature, times(blur.oblique, blur.oblique));
  const std::int64_t skew = times(bent * q<16>(0.26).raw() / blur.across, blur.inverse);
  out.skew = to32(shift_round(skew, 16 - kProfileFraction));
  if (magnitude(std::int64_t{out.skew}) < kLeastSkew) out.skew = 0;
  const std::int64_t n_u = curve.rows ? blur.nx : blur.ny;
  const std::int64_t half_bend = times(curve.curvature, kOne16 - times(n_u, n_u)) / 2;
  out.quadratic = saturate32(-shift_round(half_bend * blur.inverse, 18));
  out.cubic =
      saturate32(-shift_round(times(times(half_bend, curve.curvature), n_u) * blur.inverse, 18));
}

// How far stations reach on both sides; false where a neighbour leaves no room.
bool set_reach(const OutlineVertex& a, const OutlineVertex& b, std::int64_t width,
               const LocalBlur& blur, std::int64_t n_u, PixelModel& out) {
  const std::int64_t sigma = (std::int64_t{1} << 32) / blur.inverse;
  std::int64_t reach = times(kWindowSigmas, sigma) + kOne16 / 2;
  if (reach > kMaxReach) reach = kMaxReach;
  std::int64_t outside = a.outside_px < b.outside_px ? a.outside_px.raw() : b.outside_px.raw();
  // Leave the neighbour its blur, but never less than half of the gap.
  const std::int64_t polite = outside - (5 * sigma) / 2;
  outside = polite > outside / 2 ? polite : outside / 2;
  if (outside > reach) outside = reach;
  const std::int64_t steep = static_cast<std::int64_t>(magnitude(n_u));
  if (outside < kOne16 || steep < kMinNormal) return false;
  const std::int64_t inside = width / 2 < reach ? width / 2 : reach;
  out.inside = to32((inside * kOne16) / steep);
  out.outside = to32((outside * kOne16) / steep);
  return true;
}

void set_levels(const OutlineVertex& a, const SegmentModel& model, bool rows, PixelModel& out) {
  constexpr int kFiner = 1 << (8 - kLevelFraction);
  out.black = model.black * kFiner;
  out.contrast = model.contrast * kFiner;
  out.black_per_px = slope_along(model.black_slope, a, rows ? 0 : 1);
  out.contrast_per_px = slope_along(model.contrast_slope, a, rows ? 0 : 1);
  out.noise = model.noise_q8;
  out.per_noise = (1 << 20) / model.noise_q8;
  out.low = (7 * model.noise_q8) / 2;
  out.high = kScaleEnd - out.low;
}

}  // namespace

bool make_pixel_model(const OutlinePiece& piece, const OutlineVertex& a, const OutlineVertex& b,
                      const SegmentModel& model, const ScanCurve& curve, PixelModel& out,
                      Px& sigma_px) {
  LocalBlur blur;
  if (!make_local_blur(a, b, model, curve.curvature, blur)) return false;
  sigma_px = Px::from_wide(blur.sigma);
  const std::int64_t width = (std::int64_t{a.width_px.raw()} + b.width_px.raw()) / 2;
  const std::int64_t lit = shift_by_light(a, model, blur);
  if (!set_place(piece, width, lit, model, blur, curve.curvature, out)) return false;
  if (!set_reach(a, b, width, blur, curve.rows ? blur.nx : blur.ny, out)) return false;
  set_shape(blur, curve, out);
  set_levels(a, model, curve.rows, out);
  return true;
}

}  // namespace berth
