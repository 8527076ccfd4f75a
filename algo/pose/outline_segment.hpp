// One segment of an outline made ready for its pixels: where it crosses each scan line, and the
// grey levels expected beside it. Equations in outline_edges.hpp.
//
// Between two vertices the outline is a cubic over the scan lines (Hermite, tangents from the
// normals). Blur, and with it x, changes as the edge turns: what it gains from end to end is kept
// to first order. Motion oblique to a curved edge skews the profile: for a box of variance v_m at
// an angle, the third cumulant of n - kappa t^2 / 2 is 1.2 kappa c^2, c = n^T S t.
#pragma once

#include <cstdint>

#include "pose/outline_edges.hpp"
#include "pose/outline_profile.hpp"

namespace berth {

/// The outline between two vertices over scan lines m (image rows, or columns).
struct ScanCurve {
  bool rows;                          // scan lines are image rows
  bool swapped;                       // runs from b to a
  std::int32_t m0, u0, length;        // Q<16> px
  std::int32_t per_length;            // 1 / length, Q<26>
  std::int32_t first, second, third;  // of u in the share s of the length, Q<20>
  std::int32_t normal, normal_gain;   // n_u at the start, and what it gains, Q<16>
  std::int32_t wedge, wedge_gain;     // the same of |n_u| - |n_m|
  std::int32_t curvature;             // 1/px Q<16>, white convex > 0

  /// Share (Q<20>) of the length at tau (Q<16> px) beyond the start.
  std::int32_t share_at(std::int32_t tau) const { return scaled(tau, per_length, 22); }
  /// Place on that scan line, Q<16> px.
  std::int32_t place_at(std::int32_t tau, std::int32_t share) const {
    const std::int32_t bent = second + scaled(share, third, 20);
    return u0 + scaled(tau, first + scaled(share, bent, 20), 20);
  }
  /// a b 2^-shift, to nearest.
  static std::int32_t scaled(std::int32_t a, std::int32_t b, int shift) {
    return narrow<std::int32_t>(shift_round(std::int64_t{a} * b, shift));
  }
};

/// Fills `curve`. False where no scan line lies between the vertices or the outline is not crossed
/// steeply enough.
bool make_scan_curve(const OutlineVertex& a, const OutlineVertex& b, ScanCurve& curve);

/// A `_gain` is what a value gains from the first scan line to the last; others are those of the
/// segment's middle.
struct PixelModel {
  const EdgeProfile* profile;
  std::int32_t x0, x0_gain;        // x at the crossing, on the first scan line, Q<12>
  std::int32_t pulse, pulse_gain;  // x' = pulse - x, likewise; 0: no opposite edge near
  std::int32_t linear[3];          // of x in e, 1/px: a parabola over the share, Q<14>
  std::int32_t quadratic, cubic;   // the same of e^2 and e^3, Q<14>
  std::int32_t skew;               // P gains skew (p - x^2 p), Q<13>
  std::int32_t inside, outside;    // reach along the scan line, px Q<16>
  std::uint32_t per_curvature;     // 1 / |kappa|, px Q<16>
  std::int32_t black, contrast;    // DN, Q<8>
  std::int32_t black_per_px, contrast_per_px;
  std::int32_t noise, per_noise;  // DN Q<8>; sigmas per DN, Q<12>
  std::int32_t low, high;         // levels beyond which the scale's ends count, DN Q<8>
};

/// Fills `out`. False where the segment is of no use (blurred beyond its width, too close to a
/// neighbour). `sigma_px`: the blur across the edge. Cost: about 450 instructions.
bool make_pixel_model(const OutlinePiece& piece, const OutlineVertex& a, const OutlineVertex& b,
                      const OutlineMiddle& middle, const SegmentModel& model,
                      const ScanCurve& curve, PixelModel& out, Px& sigma_px);

}  // namespace berth
