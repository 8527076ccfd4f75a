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
#pragma once

#include <cstdint>

#include "image/view.hpp"
#include "pose/outline_geometry.hpp"

namespace berth {

constexpr int kMaxWindow = 25;     // pixels of a station
constexpr int kFullWeight = 16;    // robust weight of an undisturbed station
constexpr int kLevelFraction = 4;  // grey levels and residuals, DN

/// Blur of the image as a covariance, px^2; pixel area included.
struct ImageBlur {
  Q<16> xx = q<16>(1.0), xy, yy = q<16>(1.0);
};

/// What the model needs for one segment.
struct SegmentModel {
  std::int32_t black = 0, contrast = 16;  // b and C > 0 at the segment's middle, DN, Q<4>
  // Their slopes across the marker's plane, DN per mm, Q<16>.
  std::int32_t black_slope[2] = {}, contrast_slope[2] = {};
  Q<16> edge_offset;  // o
  ImageBlur blur;
  Q<16> blur_floor;  // smaller eigenvalue of the blur: what is not motion
  // Robust weighting: mean squared residual of an ordinary station, DN^2 Q<8>; 0: no weighting.
  std::int32_t ordinary_q8 = 0;
  bool judge_shift = false;  // near convergence: a displaced station is an outlier as well
  std::int32_t stride = 1;   // power of two: every stride-th row or column
};

/// Weighted sums over a segment, w = 0 .. kFullWeight. P, its slope p and h = x p are Q<13>.
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
  Px sigma_px;                              // s
};

/// Counts of stations by mean squared residual, eight classes an octave, for its median.
struct ResidualHistogram {
  static constexpr int kClasses = 192;
  std::uint16_t count[kClasses] = {};
  std::int32_t total = 0;
  void add(std::uint32_t mean_square_q8);
  /// Median of the mean squared residual, DN^2 Q<8>, to 9 %; 0 when empty.
  std::int32_t median_q8() const;
};

/// Measures the segment between two vertices of one piece. Cost: about 250 + 300 per station.
void measure_segment(const ImageView& image, const OutlinePiece& piece, const OutlineVertex& a,
                     const OutlineVertex& b, const SegmentModel& model, SegmentSums& sums,
                     ResidualHistogram& histogram);

}  // namespace berth
