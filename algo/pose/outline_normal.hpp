// Normal equations of the outline refinement, the grey levels of each sector eliminated.
//
//   r = db + dC P - (C / s) p delta,  delta = J xi,  xi = (omega, dt / lever, o / 16)
//
// Least squares over all pixels. db and dC of a sector appear in its pixels only, so they are
// eliminated as the sector ends (Schur complement, done by orthogonalisation against 1 and P - P_):
//   A -= u u^T + v v^T,  u = B_1 / sqrt(n),  v = (B_P - P_ B_1) / sqrt(sum (P - P_)^2)
// Formats: A is Q<14> (DN^2 per unit^2), b Q<17>; |A| < 2^60 for 3000 stations of 255 DN contrast.
#pragma once

#include <cstdint>

#include "fixed/roots.hpp"
#include "pose/outline_edges.hpp"

namespace berth {

constexpr int kOffsetScale = 16;  // the edge offset's unknown is o / 16

/// The lower triangle of a matrix of all unknowns, row by row.
constexpr int kOutlineTerms = kOutlineUnknowns * (kOutlineUnknowns + 1) / 2;
using OutlineTriangle = std::int64_t[kOutlineTerms];

// Sums begin as zeros by `= {}`; without it nothing is cleared that is written anyway.

/// The row that a dimension of the target would add to the equations (outline_sizes.hpp).
struct SizeRow {
  std::int64_t row[kOutlineUnknowns];  // Q<14>
  std::int64_t self;                   // Q<14>
  std::int64_t vector;                 // as the equations'
  std::int64_t by_black, by_contrast;  // of a sector, Q<18>
};

struct OutlineNormal {
  OutlineTriangle matrix;
  std::int64_t vector[kOutlineUnknowns];
  std::int64_t square;        // sum of w r^2, Q<12>
  std::int64_t explained;     // what of it levels and step take off
  std::int64_t pixels;        // sum of w, Q<4>
  std::int64_t displacement;  // sum of (p r)^2 / (p p) over segments, as shifts: W delta^2
  std::int64_t information;   // sum of W, Q<4>
  std::int32_t sectors, segments;
  SizeRow sizes[kMeasuredSizes];
};

/// Whether light slopes across a dot as the plate's does not: residuals regressed on n_i P beside a
/// shift of the dot, p n_i, for both image axes i. All Q<12>; residuals in DN.
struct SlopeTest {
  std::int64_t step_step[2], slope_step[2], slope_slope[2];
  std::int64_t step_residual[2], slope_residual[2];
};

/// What a sector says of the unknowns, its levels eliminated once it is complete.
struct SectorEquations {
  OutlineTriangle matrix;                 // Q<14>
  std::int64_t vector[kOutlineUnknowns];  // Q<13>
  SizeRow sizes[2];        // of the marker: that with the even number, and the odd one
  OutlineSize size;        // one of the marker's
  std::int64_t square;     // Q<12>
  std::int64_t explained;  // what of it its levels take off
  std::int64_t pixels;     // Q<4>
  std::int64_t information, displacement;
  std::int32_t segments;
};

/// What a sector says of its levels: sums over its pixels of 1 and P, with one another and with the
/// residuals. `SectorEquations::pixels` is the sum of 1.
struct LevelSums {
  std::int64_t step, step_step;          // Q<17>
  std::int64_t residual, step_residual;  // Q<8>, Q<21>
};

/// The same with what pose and edge offset do to the pixels.
struct LevelShare {
  std::int64_t by_black[kOutlineUnknowns], by_contrast[kOutlineUnknowns];  // Q<18>
};

/// Sums of one sector as its segments come in.
struct SectorSums : SectorEquations, LevelSums, LevelShare {
  SlopeTest light;
  std::int32_t stations, rejected;
  std::int32_t disturbed;  // segments whose light is not the sector's, or mostly rejected
};

/// The pixels that a segment moves by for each lever of its dimension, along the normal: Q<5>,
/// |gain| <= 2^15; 0 where sizes are not asked for.
struct SegmentSize {
  OutlineSize size = OutlineSize::kNone;
  std::int32_t gain = 0;
};

/// `contrast` DN Q<4>. Cost: about 600 instructions, 800 with a size.
void add_segment(const SegmentSums& segment, const OutlineMiddle& middle, std::int32_t contrast,
                 const SegmentSize& size, SectorSums& sector);

void add_to_slope_test(const SegmentSums& segment, const OutlineMiddle& middle, SlopeTest& light);

/// Whether a segment has levels of its own (a shadow's edge, a glint, an occluder): its residuals'
/// part along 1 or P beyond 5 sigma and 4 % of the contrast, or most stations rejected.
/// `variance_q8`: mean squared residual of ordinary pixels, DN^2.
bool is_disturbed(const SegmentSums& segment, std::int32_t contrast, std::int32_t variance_q8);

/// Whether a dot's light slopes by more than 3 sigma and 3 % of the contrast from centre to edge: a
/// shadow's edge or a glint that no single segment gives away, but that moves the dot.
bool is_lit_unevenly(const SlopeTest& light, std::int32_t contrast, std::int32_t variance_q8);

/// Change of the sector's levels that its residuals ask for, DN Q<4>; false: not observable.
struct LevelChange {
  std::int32_t black = 0, contrast = 0;
};
bool solve_levels(const LevelSums& sums, std::int64_t pixels, LevelChange& change);

/// Orthonormal basis of what the levels of a sector can explain: 1 / sqrt(n) and
/// (P - mean P) / sqrt(spread); the residuals' components along it.
struct LevelBasis {
  bool valid = false;
  std::int32_t mean = 0;              // of P, Q<13>
  QuickDivisor twice_root_n{1};       // 2 sqrt(n), Q<10>
  QuickDivisor root_spread{1};        // sqrt(sum (P - mean)^2), Q<16>
  std::int32_t black = 0, white = 0;  // components of the residuals, DN Q<10>

  /// Components (u, v) of a regressor with sums over 1 and P given in Q<f>; result Q<f - 11>.
  void project(std::int64_t by_black, std::int64_t by_contrast, std::int32_t& u,
               std::int32_t& v) const;
};
LevelBasis level_basis(const SectorSums& sector);

/// Takes out of the sector's equations what its levels explain. Cost: about 1600 instructions.
void eliminate_levels(const LevelBasis& basis, SectorSums& sector);

/// What a step x (Q<30>) takes off the sector's sum of squares, 2 b^T x - x^T A x: Q<12>. Cost:
/// about 1000 instructions.
std::int64_t gain_of_step(const SectorEquations& sector,
                          const std::int64_t (&step)[kOutlineUnknowns]);

/// How much more the sector's segments are displaced than noise would have it once the step is
/// taken, F = mean of W delta^2 / sigma^2, drawn towards 1 by kExpectedSegments segments; Q<8>, at
/// least 1. What the model does not know of a marker (light, neighbours, profile) shows here first.
std::int64_t excess_q8(const SectorEquations& sector, std::int64_t gain, std::int32_t variance_q8);

/// Adds `weight` times a sector, Q<8>, |weight| <= 1. Cost: 750 instructions where it is 1, else
/// 1300.
constexpr std::int32_t kWholeSector = 1 << 8;
void add_sector(const SectorEquations& sector, std::int32_t weight, OutlineNormal& normal);

}  // namespace berth
