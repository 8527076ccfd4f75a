#include "pose/outline_segment.hpp"

#include "fixed/roots.hpp"
#include "fixed/wide.hpp"

namespace berth {
namespace {

// Products here are the upper halves of such whose factors are raised to near 2^30.

constexpr std::int32_t kOne16 = 1 << 16;
constexpr std::int32_t kWindowSigmas = q<21>(2.7).raw();
constexpr std::int32_t kMaxReach = q<16>(8.5).raw();  // px across the edge
constexpr std::int32_t kMinNormal = q<16>(0.3).raw();
constexpr std::int32_t kShortStep = q<16>(0.25).raw();
constexpr std::int32_t kShortest = 1 << 12, kLongest = 1 << 23;  // of a segment, px Q<16>
constexpr std::int32_t kLeastSkew = 8;  // Q<13>: 0.0004 of the contrast at most
constexpr std::int32_t kPulseReach =
    7 << 12;  // Q<12>: the opposite edge counts when nearer, in sigma
constexpr std::int32_t kMostWidth = 64 << 16;  // px Q<16>: more than that at any blur

std::int32_t absolute(std::int32_t v) { return v < 0 ? -v : v; }
std::int32_t clamp(std::int32_t v, std::int32_t limit) {
  return v > limit ? limit : (v < -limit ? -limit : v);
}

// a / b of normals, Q<20>, within 2^-20: what a 32-bit division leaves is divided once more.
std::int32_t ratio(std::int32_t a, std::int32_t b) {
  const std::int32_t up = raised(a, 14), whole = up / b;  // |a| <= 2^16, kMinNormal <= |b|
  const std::int32_t rest = up - whole * b;               // below |b| <= 2^16
  return whole * (1 << 6) + rest * (1 << 6) / b;
}

// kappa = -dn . dp / |dp|^2 between the vertices, with dp = h (c, 1) and |c| <= 1: `chord` c Q<28>,
// gains of the normal along u and m Q<16>, `per_h` 1 / h. False where |kappa| >= 1.
bool curvature_of(std::int32_t gain_u, std::int32_t gain_m, std::int32_t chord, std::int32_t h,
                  Reciprocal per_h, std::int32_t& curvature) {
  const std::int32_t bend = multiply_high(raised(gain_u, 12), chord) + raised(gain_m, 8);  // Q<24>
  const std::int32_t square = multiply_high(raised(chord, 2), raised(chord, 2));  // c^2, Q<28>
  const std::uint32_t share = UINT32_MAX / ((1u << 15) + static_cast<std::uint32_t>(square >> 13));
  const std::int32_t turned = multiply_high(  // Q<20>: bend to 2^26, share Q<17> to 2^17
      raised(bend, 4), raised(static_cast<std::int32_t>(share), 7));
  if (absolute(turned) >= raised(h, 4)) return false;
  // Below h 2^4, and h 2^shift below 2^32: the shifted factor is below 2^30.
  curvature = lowered(-multiply_high(raised(turned, per_h.shift - 6), per_h.mantissa), 12);
  return true;
}

// What a cubic misses of a circle's arc on the mean over the segment, px Q<16>: the next term is
// u s^2 (1 - s)^2 h^4 / 24 with u = 3 kappa^2 u'' (1 + q^2)(1 + 5 q^2), q the slope; its
// mean is (kappa h)^2 h^2 u'' (1 + q^2)(1 + 5 q^2) / 240. Up to 0.0005 px on the largest ring.
std::int32_t mean_beyond_cubic(const ScanCurve& curve) {
  constexpr std::int32_t kMost = 1 << 21, kLeast = 1 << 15;  // a 64th: below 2^-16 px
  const std::int32_t h = raised(curve.length, 7);
  const std::int32_t turn = multiply_high(raised(curve.curvature, 14), h);  // Q<21>
  if (turn > kMost || turn < -kMost) return 0;                              // no outline of ours
  if (turn < kLeast && turn > -kLeast) return 0;
  const std::int32_t turn_square = multiply_high(raised(turn, 9), raised(turn, 9));  // Q<28>
  // h^2 u'' halfway, Q<16>: slopes of at most 3.4 at the ends and 1 between make the sum < 53.
  const std::int32_t sagitta = multiply_high(raised(2 * curve.second + 3 * curve.third, 5), h);
  const std::int32_t q = (4 * (curve.first + curve.second) + 3 * curve.third) >> 6;  // Q<16>
  if (q > 4 * kOne16 || q < -4 * kOne16) return 0;                                   // nor this
  const std::int32_t q2 = multiply_high(raised(q, 12), raised(q, 12));               // Q<24>
  const std::int32_t steepness = multiply_high((1 << 24) + q2, (1 << 24) + 5 * q2);  // Q<16>
  const std::int32_t share = multiply_high(raised(turn_square, 2), sagitta);         // Q<14>
  return saturate32(shift_round(std::int64_t{share} * steepness, 14)) / 240;
}

}  // namespace

bool make_scan_curve(const OutlineVertex& a, const OutlineVertex& b, ScanCurve& curve) {
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
  const std::int32_t t0 = normal(first, m), t1 = normal(last, m);
  if (absolute(n0) < kMinNormal || absolute(n1) < kMinNormal || (n0 < 0) != (n1 < 0)) return false;
  curve.m0 = first.point_px[m].raw();
  curve.u0 = first.point_px[1 - m].raw();
  const std::int32_t h = last.point_px[m].raw() - curve.m0;
  curve.length = h;
  if (h < kShortest || h > kLongest) return false;
  // du / h Q<28>: with both shifted left, |du| <= h < 2^(32 - shift), 8 <= shift <= 19.
  const Reciprocal per_h = reciprocal(static_cast<std::uint32_t>(h));
  const std::int32_t chord =
      multiply_high(raised(last.point_px[1 - m].raw() - curve.u0, per_h.shift - 2), per_h.mantissa);
  if (!curvature_of(n1 - n0, t1 - t0, chord, h, per_h, curve.curvature)) return false;
  curve.per_length = per_h.mantissa >> (20 - per_h.shift);
  curve.wedge = absolute(n0) - absolute(t0);
  curve.wedge_gain = absolute(n1) - absolute(t1) - curve.wedge;
  curve.normal = n0;
  curve.normal_gain = n1 - n0;
  curve.first = lowered(chord, 8);
  curve.second = curve.third = 0;
  if (h < kShortStep) return true;
  // Hermite: slopes of the tangent, perpendicular to the normal, at both ends.
  const std::int32_t q0 = -ratio(t0, n0), q1 = -ratio(t1, n1);
  curve.second = 3 * curve.first - 2 * q0 - q1;
  curve.third = q0 + q1 - 2 * curve.first;
  curve.first = q0;
  curve.u0 += mean_beyond_cubic(curve);
  return true;
}

namespace {

// Blur beside a segment, px^2 Q<16> unless said; n, t: normal and tangent halfway, |n| <= 1. Its
// eigenvalues stay below 12, curvatures below 1, so that everything fits 32 bits.
struct LocalBlur {
  std::int32_t nx, ny;            // Q<30>
  std::int32_t cos_2, sin_2;      // Q<16>
  std::int32_t light_x, light_y;  // S n, Q<24>
  std::int32_t across, oblique;   // n^T S n, n^T S t
  std::int32_t box;               // what of across is motion
  std::int32_t turned;            // what across gains from a to b
  std::int32_t bend;              // kappa t^T S t, px Q<24>
  std::int32_t sigma;             // px
  std::int32_t widened, inverse;  // by the curve: px; 1/px
  std::int32_t per_across;        // 1/px^2
};

// S v: S Q<26>, v Q<f> below 2^30; Q<f - 6>.
struct Across {
  std::int32_t xx, xy, yy;
  std::int32_t x(std::int32_t vx, std::int32_t vy) const {
    return multiply_high(vx, xx) + multiply_high(vy, xy);
  }
  std::int32_t y(std::int32_t vx, std::int32_t vy) const {
    return multiply_high(vx, xy) + multiply_high(vy, yy);
  }
};

bool make_local_blur(const OutlineVertex& a, const OutlineVertex& b, const OutlineMiddle& middle,
                     const SegmentModel& model, std::int32_t curvature, LocalBlur& out) {
  const ImageBlur& v = model.blur;
  const Across s{raised(v.xx.raw(), 10), raised(v.xy.raw(), 10), raised(v.yy.raw(), 10)};
  const std::int32_t nx = raised(middle.normal_x.raw(), 14);
  const std::int32_t ny = raised(middle.normal_y.raw(), 14);
  out.nx = nx;
  out.ny = ny;
  out.cos_2 = lowered(multiply_high(nx, nx) - multiply_high(ny, ny), 12);
  out.sin_2 = lowered(multiply_high(nx, ny), 11);
  out.light_x = s.x(nx, ny);
  out.light_y = s.y(nx, ny);
  out.across = lowered(multiply_high(nx, out.light_x) + multiply_high(ny, out.light_y), 6);
  out.oblique = lowered(multiply_high(nx, out.light_y) - multiply_high(ny, out.light_x), 6);
  const std::int32_t along = v.xx.raw() + v.yy.raw() - out.across;
  // n_b^T S n_b - n_a^T S n_a = (n_b - n_a)^T S (n_b + n_a), Q<20>
  const std::int32_t ax = a.normal_x.raw(), ay = a.normal_y.raw();
  const std::int32_t bx = b.normal_x.raw(), by = b.normal_y.raw();
  const std::int32_t sum_x = raised(ax + bx, 13), sum_y = raised(ay + by, 13);
  out.turned = lowered(multiply_high(raised(bx - ax, 13), s.x(sum_x, sum_y)) +
                           multiply_high(raised(by - ay, 13), s.y(sum_x, sum_y)),
                       4);
  const std::int32_t floor = model.blur_floor.raw();
  out.box = out.across > floor ? out.across - floor : 0;
  // Var(t^2) is 2 v^2 for a Gaussian, 0.8 v^2 for the box of motion.
  const std::int32_t kappa = raised(curvature, 14);
  out.bend = multiply_high(kappa, raised(along, 10));
  std::int32_t widened = out.across + multiply_high(out.bend, out.bend) / 2;
  if (along > floor) {
    const std::int32_t moved = multiply_high(kappa, raised(along - floor, 10));  // px Q<24>
    widened -= 3 * multiply_high(moved, moved) / 10;
  }
  if (out.across < (1 << 10) || widened < (1 << 10) || widened > (40 << 16)) return false;
  const auto root = [](std::int32_t variance) {
    return static_cast<std::int32_t>(root_q16(static_cast<std::uint32_t>(variance)) >> 8);
  };
  out.sigma = root(out.across);
  out.widened = root(widened);
  out.inverse = static_cast<std::int32_t>(UINT32_MAX / static_cast<std::uint32_t>(out.widened));
  out.per_across = static_cast<std::int32_t>(UINT32_MAX / static_cast<std::uint32_t>(out.across));
  return true;
}

// Light that rises across a blurred edge: (L step) * PSF = L P + g^T S n p / s, as if the edge lay
// g^T S n / C further out, with g the slope of the contrast. px Q<16>.
std::int32_t shift_by_light(const SegmentModel& model, const LocalBlur& blur) {
  const std::int32_t gx = model.contrast_slope[0], gy = model.contrast_slope[1];
  if (gx == 0 && gy == 0) return 0;
  const std::int64_t light =
      std::int64_t{gx} * blur.light_x + std::int64_t{gy} * blur.light_y;  // Q<32>
  return clamp(saturate32(light >> (16 - kLevelFraction)) / model.contrast, kMaxReach);
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
  const std::int32_t half_gain = (curve.swapped ? -inverse_gain : inverse_gain) / 2;
  const std::int32_t first = multiply_high(raised(curve.normal, 14), blur.inverse - half_gain);
  const std::int32_t middle = multiply_high(curve.rows ? blur.nx : blur.ny, blur.inverse);
  const std::int32_t last =
      multiply_high(raised(curve.normal + curve.normal_gain, 14), blur.inverse + half_gain);
  out.linear[0] = first;
  out.linear[1] = 4 * middle - 3 * first - last;
  out.linear[2] = 2 * (first + last) - 4 * middle;
}

// x at the crossing, the opposite edge, and how both change along the segment. False where nothing
// is left between the edges.
bool set_place(const OutlinePiece& piece, std::int32_t width, std::int32_t lit,
               const SegmentModel& model, const LocalBlur& blur, const ScanCurve& curve,
               PixelModel& out) {
  // 1 / s is below 2^19, lengths below 2^22 but for the width of a far opposite edge.
  const std::int32_t inverse = blur.inverse;
  const auto in_sigmas = [&](std::int32_t px) {  // Q<16> to Q<12>
    return multiply_high(raised(px, 8), raised(inverse, 4));
  };
  const std::int32_t offset = multiply_high(
      raised(model.edge_offset.along(blur.cos_2, blur.sin_2), 13), raised(blur.sigma, 3));
  const std::int32_t half_bend = lowered(blur.bend, 9);  // px Q<16>
  const std::int32_t bends = 1 + piece.opposite_curvature;
  const std::int32_t apart = (width < kMostWidth ? width : kMostWidth) + 2 * offset;
  const std::int32_t pulse = in_sigmas(apart - bends * half_bend);
  if (pulse <= 0) return false;
  out.x0 = in_sigmas(offset + lit - half_bend);
  out.pulse = pulse < kPulseReach ? pulse : 0;
  out.pulse_gain = 0;
  // 1/s loses half of what v_n gains, to first order and so at most all; v_t loses what v_n gains.
  const std::int32_t gain =
      -clamp(multiply_high(raised(blur.turned, 11), raised(blur.per_across, 4)), 1 << 16);  // Q<16>
  const std::int32_t bend_gain =
      multiply_high(multiply_high(raised(curve.curvature, 14), raised(blur.turned, 10)),
                    raised(inverse, 3));  // of half the bend, Q<12>
  out.x0_gain = multiply_high(raised(out.x0, 8), raised(gain, 8)) + bend_gain;
  run_along(curve, out.x0, out.x0_gain);
  if (out.pulse != 0) {
    out.pulse_gain = multiply_high(raised(out.pulse, 8), raised(gain, 8)) + bends * bend_gain;
    run_along(curve, out.pulse, out.pulse_gain);
  }
  set_linear(curve, blur, multiply_high(raised(inverse, 8), raised(gain, 8)), out);
  return true;
}

void set_shape(const LocalBlur& blur, const ScanCurve& curve, PixelModel& out) {
  const std::int32_t shape = (kProfileShapes * blur.box + blur.across / 2) / blur.across;
  out.profile = &edge_profile(shape < kProfileShapes ? shape : kProfileShapes - 1);
  const std::int32_t kappa = raised(curve.curvature, 14);  // Q<30>
  // 1.2 kappa c^2 / (6 s^3), and what its next order adds for the smallest dots. |c| < 6.
  const std::int32_t square =
      multiply_high(raised(blur.oblique, 12), raised(blur.oblique, 12));  // Q<24>
  const std::int32_t share =
      multiply_high(raised(multiply_high(kappa, square), 3), raised(blur.per_across, 8));  // Q<17>
  const std::int32_t factor = multiply_high(raised(blur.inverse, 11), q<30>(0.26).raw());  // Q<25>
  static_assert(kProfileFraction == 17 + 28 - 32);
  out.skew = multiply_high(share, raised(factor, 3));
  if (absolute(out.skew) < kLeastSkew) out.skew = 0;
  const std::int32_t n_u = curve.rows ? blur.nx : blur.ny;
  const std::int32_t half_bend =  // kappa t_u^2 / 2, Q<30>
      raised(multiply_high(kappa, (1 << 28) - multiply_high(n_u, n_u)), 3);
  out.quadratic = -multiply_high(half_bend, blur.inverse);
  const std::int32_t turned = multiply_high(raised(multiply_high(half_bend, kappa), 2), n_u);
  out.cubic = -multiply_high(raised(turned, 2), blur.inverse);
}

// How far stations reach on both sides; false where a neighbour leaves no room.
bool set_reach(const OutlineVertex& a, const OutlineVertex& b, std::int32_t width,
               const LocalBlur& blur, bool rows, PixelModel& out) {
  const std::int32_t sigma = blur.widened;  // below 6.4
  std::int32_t reach = multiply_high(kWindowSigmas, raised(sigma, 11)) + kOne16 / 2;
  if (reach > kMaxReach) reach = kMaxReach;
  std::int32_t outside = a.outside_px < b.outside_px ? a.outside_px.raw() : b.outside_px.raw();
  // Leave the neighbour its blur, but never less than half of the gap.
  const std::int32_t polite = outside - (5 * sigma) / 2;
  outside = polite > outside / 2 ? polite : outside / 2;
  if (outside > reach) outside = reach;
  const std::int32_t steep = absolute(rows ? blur.nx : blur.ny) >> 18;  // Q<12>
  if (outside < kOne16 || steep < kMinNormal >> 4) return false;
  const std::int32_t inside = width / 2 < reach ? width / 2 : reach;
  const auto along = [&](std::int32_t px) {  // below 2^20, to 0.1 %
    return static_cast<std::int32_t>((static_cast<std::uint32_t>(px) << 12) /
                                     static_cast<std::uint32_t>(steep));
  };
  out.inside = along(inside);
  out.outside = along(outside);
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
  if (!set_reach(a, b, width, blur, curve.rows, out)) return false;
  set_shape(blur, curve, out);
  set_levels(model, curve.rows, out);
  const std::int32_t bend = absolute(curve.curvature);
  out.per_curvature = bend == 0 ? UINT32_MAX : UINT32_MAX / static_cast<std::uint32_t>(bend);
  return true;
}

}  // namespace berth
