#include "pose/outline_segment.hpp"

#include "fixed/roots.hpp"
#include "fixed/wide.hpp"

namespace berth {
namespace {

constexpr std::int32_t kOne16 = 1 << 16;
constexpr std::int32_t kWindowSigmas = q<16>(2.7).raw();
constexpr std::int32_t kMaxReach = q<16>(8.5).raw();  // px across the edge
constexpr std::int32_t kMinNormal = q<16>(0.3).raw();
constexpr std::int32_t kShortStep = q<16>(0.25).raw();
constexpr std::int32_t kLeastSkew = 8;  // Q<13>: 0.0004 of the contrast at most
constexpr int kPulseReach = 7 << 12;    // Q<12>: the opposite edge counts when nearer, in sigma

std::int32_t to32(std::int64_t v) { return narrow<std::int32_t>(v); }
std::int64_t product(std::int32_t a, std::int32_t b) { return std::int64_t{a} * b; }
std::int32_t times(std::int32_t a, std::int32_t b) {  // Q<16>
  return to32(shift_round(product(a, b), 16));
}
std::int32_t absolute(std::int32_t v) { return v < 0 ? -v : v; }

// 1 / v of either sign, v != 0.
Reciprocal signed_reciprocal(std::int32_t v) {
  Reciprocal r = reciprocal(static_cast<std::uint32_t>(absolute(v)));
  if (v < 0) r.mantissa = -r.mantissa;
  return r;
}

// kappa = -dn . dp / |dp|^2 between the vertices. |dp| >= 1/16 px.
bool curvature_of(const OutlineVertex& a, const OutlineVertex& b, std::int32_t& curvature) {
  const std::int32_t dx = b.point_px[0].raw() - a.point_px[0].raw();
  const std::int32_t dy = b.point_px[1].raw() - a.point_px[1].raw();
  const std::int64_t square = product(dx, dx) + product(dy, dy);  // Q<32>
  if (square < (std::int64_t{1} << 24) || square > (std::int64_t{1} << 46)) return false;
  const std::int64_t bend = product(b.normal_x.raw() - a.normal_x.raw(), dx) +
                            product(b.normal_y.raw() - a.normal_y.raw(), dy);  // Q<32>
  // |bend| < 2^42; dropped bits are nothing beside 1/16 px squared.
  const int drop = square < (std::int64_t{1} << 44) ? 12 : 16;
  const Reciprocal r = reciprocal(static_cast<std::uint32_t>(square >> drop));
  curvature = saturate32(-multiply_reciprocal(to32(bend >> drop), r, 16));
  return curvature < kOne16 && curvature > -kOne16;
}

// What a cubic misses of a circle's arc on the mean over the segment, px Q<16>: the next term is
// u s^2 (1 - s)^2 h^4 / 24 with u = 3 kappa^2 u'' (1 + q^2)(1 + 5 q^2), q the slope; its
// mean is (kappa h)^2 h^2 u'' (1 + q^2)(1 + 5 q^2) / 240. Up to 0.0005 px on the largest ring.
std::int32_t mean_beyond_cubic(const ScanCurve& curve) {
  const std::int64_t turn = shift_round(product(curve.curvature, curve.length), 16);
  if (turn > kOne16 || turn < -kOne16) return 0;  // no outline of ours
  const std::int32_t turn_square = times(to32(turn), to32(turn));
  const std::int32_t sagitta = to32(  // h^2 u'' halfway
      shift_round(product(2 * curve.second + 3 * curve.third, curve.length), 20));
  const std::int32_t q = to32(shift_round(
      4 * (std::int64_t{curve.first} + curve.second) + 3 * std::int64_t{curve.third}, 6));
  const std::int32_t q2 = times(q, q);
  const std::int32_t steepness = times(kOne16 + q2, kOne16 + 5 * q2);
  return saturate32(shift_round(product(times(turn_square, sagitta), steepness), 16)) / 240;
}

}  // namespace

bool make_scan_curve(const OutlineVertex& a, const OutlineVertex& b, ScanCurve& curve) {
  if (!curvature_of(a, b, curve.curvature)) return false;
  const std::int32_t dx = b.point_px[0].raw() - a.point_px[0].raw();
  const std::int32_t dy = b.point_px[1].raw() - a.point_px[1].raw();
  curve.rows = absolute(dy) >= absolute(dx);
  const int m = curve.rows ? 1 : 0;
  const bool swap = a.point_px[m] > b.point_px[m];
  curve.swapped = swap;
  const OutlineVertex& first = swap ? b : a;
  const OutlineVertex& last = swap ? a : b;
  const auto normal = [](const OutlineVertex& v, int axis) {
    return axis == 0 ? v.normal_x.raw() : v.normal_y.raw();
  };
  const std::int32_t n0 = normal(first, 1 - m), n1 = normal(last, 1 - m);
  if (absolute(n0) < kMinNormal || absolute(n1) < kMinNormal || (n0 < 0) != (n1 < 0)) return false;
  curve.m0 = first.point_px[m].raw();
  curve.u0 = first.point_px[1 - m].raw();
  const std::int32_t h = last.point_px[m].raw() - curve.m0;
  curve.length = h;
  if (h <= (1 << 11)) return false;  // hardly a scan line in between
  curve.wedge = absolute(n0) - absolute(normal(first, m));
  curve.wedge_gain = absolute(n1) - absolute(normal(last, m)) - curve.wedge;
  const Reciprocal per_h = reciprocal(static_cast<std::uint32_t>(h));
  curve.per_length = to32(multiply_reciprocal(1, per_h, 42));  // h > 2^11: below 2^31
  const std::int32_t chord =
      to32(multiply_reciprocal(last.point_px[1 - m].raw() - curve.u0, per_h, 20));
  curve.normal = n0;
  curve.normal_gain = n1 - n0;
  curve.first = chord;
  curve.second = curve.third = 0;
  if (h < kShortStep) return true;
  // Hermite: slopes of the tangent, perpendicular to the normal, at both ends.
  const std::int32_t q0 = to32(-multiply_reciprocal(normal(first, m), signed_reciprocal(n0), 20));
  const std::int32_t q1 = to32(-multiply_reciprocal(normal(last, m), signed_reciprocal(n1), 20));
  curve.first = q0;
  curve.second = 3 * chord - 2 * q0 - q1;
  curve.third = q0 + q1 - 2 * chord;
  curve.u0 += mean_beyond_cubic(curve);
  return true;
}

namespace {

// n^T S n at a vertex, px^2 Q<16>.
std::int32_t variance_across(const ImageBlur& v, const OutlineVertex& p) {
  const std::int32_t nx = p.normal_x.raw(), ny = p.normal_y.raw();
  return times(times(nx, nx), v.xx.raw()) + 2 * times(times(nx, ny), v.xy.raw()) +
         times(times(ny, ny), v.yy.raw());
}

// Blur beside a segment, px^2 Q<16>; n, t: normal and tangent halfway, |n| <= 1. Variances stay
// below 12, curvatures below 1, so that everything fits 32 bits.
struct LocalBlur {
  std::int32_t nx, ny, cos_2, sin_2;    // Q<16>
  std::int32_t across, along, oblique;  // n^T S n, t^T S t, n^T S t
  std::int32_t box, moved;              // what of across and along is motion
  std::int32_t turned;                  // what across gains from a to b
  std::int32_t sigma;                   // px
  std::int32_t widened, inverse;        // by the curve: px; 1/px
  Reciprocal per_across;
};

bool make_local_blur(const OutlineVertex& a, const OutlineVertex& b, const OutlineMiddle& middle,
                     const SegmentModel& model, std::int32_t curvature, LocalBlur& out) {
  const ImageBlur& v = model.blur;
  out.nx = middle.normal_x.raw();
  out.ny = middle.normal_y.raw();
  const std::int32_t nxx = times(out.nx, out.nx), nxy = times(out.nx, out.ny);
  const std::int32_t nyy = times(out.ny, out.ny);
  out.cos_2 = nxx - nyy;
  out.sin_2 = 2 * nxy;
  out.across = times(nxx, v.xx.raw()) + 2 * times(nxy, v.xy.raw()) + times(nyy, v.yy.raw());
  out.along = v.xx.raw() + v.yy.raw() - out.across;
  out.oblique = times(out.cos_2, v.xy.raw()) - times(nxy, v.xx.raw() - v.yy.raw());
  out.turned = variance_across(v, b) - variance_across(v, a);
  const std::int32_t floor = model.blur_floor.raw();
  out.box = out.across > floor ? out.across - floor : 0;
  out.moved = out.along > floor ? out.along - floor : 0;
  // Var(t^2) is 2 v^2 for a Gaussian, 0.8 v^2 for the box of motion.
  const std::int32_t bend = times(curvature, out.along), moved = times(curvature, out.moved);
  const std::int32_t widened = out.across + times(bend, bend) / 2 - (3 * times(moved, moved)) / 10;
  if (out.across < (1 << 10) || widened < (1 << 10) || widened > (40 << 16)) return false;
  out.sigma = static_cast<std::int32_t>(isqrt(static_cast<std::uint64_t>(out.across) << 16));
  out.widened = static_cast<std::int32_t>(isqrt(static_cast<std::uint64_t>(widened) << 16));
  out.inverse = static_cast<std::int32_t>(UINT32_MAX / static_cast<std::uint32_t>(out.widened));
  out.per_across = reciprocal(static_cast<std::uint32_t>(out.across));
  return true;
}

// Light that rises across a blurred edge: (L step) * PSF = L P + g^T S n p / s, as if the edge lay
// g^T S n / C further out, with g the slope of the contrast. px Q<16>.
std::int32_t shift_by_light(const SegmentModel& model, const LocalBlur& blur) {
  const ImageBlur& v = model.blur;
  const std::int32_t gx = model.contrast_slope[0], gy = model.contrast_slope[1];
  if (gx == 0 && gy == 0) return 0;
  const std::int64_t light =
      product(gx, times(blur.nx, v.xx.raw()) + times(blur.ny, v.xy.raw())) +
      product(gy, times(blur.nx, v.xy.raw()) + times(blur.ny, v.yy.raw()));  // Q<24>
  return to32(multiply_reciprocal(saturate32(light >> (8 - kLevelFraction)),
                                  reciprocal(static_cast<std::uint32_t>(model.contrast)), 0));
}

// From the first scan line to the last one instead of from vertex a to b, Q<12>.
void run_along(const ScanCurve& curve, std::int32_t& value, std::int32_t& gain) {
  if (curve.swapped) gain = -gain;
  value -= gain / 2;
}

// n_u / s, a parabola through its values at both ends and halfway: over an arc of 30 degrees a
// straight line would be 3 % off.
void set_linear(const ScanCurve& curve, const LocalBlur& blur, std::int32_t inverse_gain,
                PixelModel& out) {
  const std::int32_t gain = curve.swapped ? -inverse_gain : inverse_gain;
  const auto at = [&](std::int32_t normal, std::int32_t inverse) {
    return to32(shift_round(product(normal, inverse), 18));
  };
  const std::int32_t first = at(curve.normal, blur.inverse - gain / 2);
  const std::int32_t middle = at(curve.rows ? blur.nx : blur.ny, blur.inverse);
  const std::int32_t last = at(curve.normal + curve.normal_gain, blur.inverse + gain / 2);
  out.linear[0] = first;
  out.linear[1] = 4 * middle - 3 * first - last;
  out.linear[2] = 2 * (first + last) - 4 * middle;
}

// x at the crossing, the opposite edge, and how both change along the segment. False where nothing
// is left between the edges.
bool set_place(const OutlinePiece& piece, std::int32_t width, std::int32_t lit,
               const SegmentModel& model, const LocalBlur& blur, const ScanCurve& curve,
               PixelModel& out) {
  const std::int32_t curvature = curve.curvature;
  const std::int32_t inverse = blur.inverse;
  const std::int32_t bend = times(curvature, blur.along);  // kappa v_t, px
  const std::int32_t offset = times(model.edge_offset.along(blur.cos_2, blur.sin_2), blur.sigma);
  const std::int32_t other_bend = (1 + piece.opposite_curvature) * (bend / 2);
  const std::int64_t pulse = shift_round(product(width + 2 * offset - other_bend, inverse), 20);
  if (pulse <= 0) return false;
  out.x0 = to32(shift_round(product(offset + lit - bend / 2, inverse), 20));
  out.pulse = pulse < kPulseReach ? to32(pulse) : 0;
  // 1/s loses half of what v_n gains; v_t loses what v_n gains.
  const std::int32_t gain = to32(-multiply_reciprocal(blur.turned, blur.per_across, 15));
  const std::int32_t bend_gain =
      to32(shift_round(product(times(curvature, blur.turned), inverse), 21));
  out.x0_gain = times(out.x0, gain) + bend_gain;
  run_along(curve, out.x0, out.x0_gain);
  if (out.pulse != 0) {
    out.pulse_gain = times(out.pulse, gain) + (1 + piece.opposite_curvature) * bend_gain;
    run_along(curve, out.pulse, out.pulse_gain);
  }
  set_linear(curve, blur, times(inverse, gain), out);
  return true;
}

void set_shape(const LocalBlur& blur, const ScanCurve& curve, PixelModel& out) {
  constexpr int kShapesLog2 = 3;
  static_assert(kProfileShapes == 1 << kShapesLog2);
  const std::int64_t shape = multiply_reciprocal(blur.box, blur.per_across, kShapesLog2);
  out.profile =
      &edge_profile(shape < kProfileShapes ? static_cast<int>(shape) : kProfileShapes - 1);
  // 1.2 kappa c^2 / (6 s^3), and what its next order adds for the smallest dots.
  const std::int32_t bent = times(curve.curvature, times(blur.oblique, blur.oblique));
  const std::int32_t share = to32(multiply_reciprocal(bent, blur.per_across, 16));
  out.skew = to32(
      shift_round(product(times(share, q<16>(0.26).raw()), blur.inverse), 32 - kProfileFraction));
  if (absolute(out.skew) < kLeastSkew) out.skew = 0;
  const std::int32_t n_u = curve.rows ? blur.nx : blur.ny;
  const std::int32_t half_bend = times(curve.curvature, kOne16 - times(n_u, n_u)) / 2;
  out.quadratic = to32(-shift_round(product(half_bend, blur.inverse), 18));
  out.cubic =
      to32(-shift_round(product(times(times(half_bend, curve.curvature), n_u), blur.inverse), 18));
}

// How far stations reach on both sides; false where a neighbour leaves no room.
bool set_reach(const OutlineVertex& a, const OutlineVertex& b, std::int32_t width,
               const LocalBlur& blur, std::int32_t n_u, PixelModel& out) {
  const std::int32_t sigma = blur.widened;
  std::int32_t reach = times(kWindowSigmas, sigma) + kOne16 / 2;
  if (reach > kMaxReach) reach = kMaxReach;
  std::int32_t outside = a.outside_px < b.outside_px ? a.outside_px.raw() : b.outside_px.raw();
  // Leave the neighbour its blur, but never less than half of the gap.
  const std::int32_t polite = outside - (5 * sigma) / 2;
  outside = polite > outside / 2 ? polite : outside / 2;
  if (outside > reach) outside = reach;
  const std::int32_t steep = absolute(n_u);
  if (outside < kOne16 || steep < kMinNormal) return false;
  const Reciprocal per_steep = reciprocal(static_cast<std::uint32_t>(steep));
  const std::int32_t inside = width / 2 < reach ? width / 2 : reach;
  out.inside = to32(multiply_reciprocal(inside, per_steep, 16));
  out.outside = to32(multiply_reciprocal(outside, per_steep, 16));
  return true;
}

void set_levels(const SegmentModel& model, bool rows, PixelModel& out) {
  constexpr int kFiner = 1 << (8 - kLevelFraction);
  out.black = model.black * kFiner;
  out.contrast = model.contrast * kFiner;
  out.black_per_px = model.black_slope[rows ? 0 : 1];
  out.contrast_per_px = model.contrast_slope[rows ? 0 : 1];
  out.noise = model.noise_q8;
  out.per_noise = (1 << 20) / model.noise_q8;
  out.low = (5 * model.noise_q8) / 2;
  out.high = kScaleEnd - out.low;
}

}  // namespace

bool make_pixel_model(const OutlinePiece& piece, const OutlineVertex& a, const OutlineVertex& b,
                      const OutlineMiddle& middle, const SegmentModel& model,
                      const ScanCurve& curve, PixelModel& out, Px& sigma_px) {
  LocalBlur blur;
  if (!make_local_blur(a, b, middle, model, curve.curvature, blur)) return false;
  sigma_px = Px::from_raw(blur.sigma);
  const std::int32_t width = (a.width_px + b.width_px).raw() / 2;
  const std::int32_t lit = shift_by_light(model, blur);
  if (!set_place(piece, width, lit, model, blur, curve, out)) return false;
  if (!set_reach(a, b, width, blur, curve.rows ? blur.nx : blur.ny, out)) return false;
  set_shape(blur, curve, out);
  set_levels(model, curve.rows, out);
  const std::int32_t bend = absolute(curve.curvature);
  out.per_curvature = bend == 0 ? UINT32_MAX : UINT32_MAX / static_cast<std::uint32_t>(bend);
  return true;
}

}  // namespace berth
