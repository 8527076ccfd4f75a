// Photometric residuals along one segment of a predicted outline.
//
// One station per pixel row (column, where the outline is nearer to horizontal): the pixels of that
// row around the predicted crossing, each used once, none interpolated. With e the offset from the
// crossing, n the normal towards white, t the tangent and kappa the curvature (convex white > 0)
//
//   d(e) = e n_u - (kappa/2) t_u^2 e^2 - (kappa^2/2) n_u t_u^2 e^3       distance to a curved edge
//   x = (d - kappa v_t / 2 + o s) / s_e,   s_e^2 = v_n + (kappa v_t)^2 / 2
//   I = b + C [P(x) + P(x') - 1],   residual r = measured - I
//
// v_n, v_t: variance of the blur (pixel's area included) across and along the edge; o: edge offset
// in units of the blur s = sqrt(v_n). The term kappa v_t / 2 is the shift that blur gives a curved
// edge (the E[.] of a parabola under a Gaussian). x' is the opposite edge of the same marker: ring,
// line and dots are pulses once blur is comparable to their width.
//
// Pixels near the ends of the scale are censored (Tobin 1958): with noise sigma and z the distance
// to the end in sigmas their mean is short of I by sigma g(-z), g(z) = z Phi(z) + phi(z), and moves
// by q = Phi(z) only. Residuals are taken to that mean; q weighs the pixel in all sums of squares.
#pragma once

#include <cstdint>

#include "image/view.hpp"
#include "pose/image_blur.hpp"
#include "pose/outline_geometry.hpp"

namespace berth {

constexpr int kMaxWindow = 25;                // pixels of a station
constexpr int kFullWeight = 16;               // robust weight of an undisturbed station
constexpr int kLevelFraction = 4;             // grey levels and residuals, DN
constexpr std::int32_t kScaleEnd = 255 << 8;  // DN Q<8>

/// Edge offset o = o_0 + o_1 (n_x^2 - n_y^2) + o_2 2 n_x n_y, outwards, in sigma of the blur: what
/// gamma and blooming do to all edges, and what an unmodelled profile does by direction.
struct EdgeOffset {
  Q<16> terms[3];
  /// Q<16>; the arguments are cosine and sine of twice the normal's angle, Q<16>.
  std::int32_t along(std::int32_t cos_2, std::int32_t sin_2) const {
    return narrow<std::int32_t>(
        terms[0].raw() +
        shift_round(std::int64_t{terms[1].raw()} * cos_2 + std::int64_t{terms[2].raw()} * sin_2,
                    16));
  }
};

/// What the model needs for one segment.
struct SegmentModel {
  std::int32_t black = 0, contrast = 16;  // b and C > 0 at the segment's middle, DN, Q<4>
  std::int32_t black_slope[2] = {}, contrast_slope[2] = {};  // DN per px of image x, y, Q<8>
  EdgeOffset edge_offset;
  ImageBlur blur;
  Q<16> blur_floor;  // smaller eigenvalue of the blur: what is not motion
  // Robust weighting: mean squared residual of ordinary pixels, DN^2 Q<8>; 0: no weighting.
  std::int32_t ordinary_q8 = 0;
  std::int32_t noise_q8 = 512;  // sensor noise, one sigma, DN Q<8>: 64 to 2^12
  bool judge_shift = false;     // near convergence: a displaced station is an outlier as well
  bool with_blur = true;        // whether the sums with h are asked for
  std::int32_t stride = 1;      // power of two: every stride-th row or column
};

/// Weighted sums over a segment, w = 0 .. kFullWeight times q where there is no residual in the
/// product. P, its slope p and h = x p are Q<13>.
struct SegmentSums {
  std::int64_t slope_residual = 0;          // w p r, Q<17>
  std::int64_t slope_slope = 0;             // w p p, Q<26>
  std::int64_t blur_residual = 0;           // w h r, Q<17>
  std::int64_t blur_blur = 0;               // w h h, Q<26>
  std::int64_t slope = 0, slope_step = 0;   // w p, w p P, Q<13>
  std::int64_t blur = 0, blur_step = 0;     // w h, w h P, Q<13>
  std::int64_t step = 0, step_step = 0;     // w P, w P P, Q<13>
  std::int64_t residual = 0;                // w r, Q<4>
  std::int64_t step_residual = 0;           // w P r, Q<17>
  std::int64_t square = 0;                  // w r r, Q<8>
  std::int32_t pixels = 0;                  // w
  std::int32_t stations = 0, rejected = 0;  // counts; rejected: w below a quarter
  std::int32_t pixel_work = 0;              // pixels looked at, twice where levels are censored
  Px sigma_px;                              // s
};

/// Measures the segment between two vertices of one piece; `sums` are empty before. Cost: about
/// 1000, 330 a station and 40 a pixel; less where stations share a batch, twice where levels are
/// censored.
void measure_segment(const ImageView& image, const OutlinePiece& piece, const OutlineVertex& a,
                     const OutlineVertex& b, const OutlineMiddle& middle, const SegmentModel& model,
                     SegmentSums& sums);

}  // namespace berth
