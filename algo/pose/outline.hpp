// Refinement of a pose on the outlines of all markers: least squares on the pixels themselves.
//
//   minimise sum_pixels w (I - b - C P(x(pose)))^2   over pose, edge offset, levels b, C and blur
//
// Gauss-Newton from a pose that is right to about 1.5 px; each station (a pixel row or column that
// crosses an outline) costs one pass over its few pixels, each sector of a marker has grey levels
// of its own, eliminated, and the blur is measured alongside. This is the maximum likelihood
// estimate for white noise, so that its spread is that of the Cramer-Rao bound; equations, formats
// and measured tables in docs/precision.md. Bias: P's slope is even about the edge, so any point-
// symmetric blur leaves straight edges unbiased; the shift of curved edges is in the model; gamma
// and saturation move all edges alike, which the edge offset takes up.
#pragma once

#include <cstdint>

#include "core/reason.hpp"
#include "image/view.hpp"
#include "pose/outline_blur.hpp"
#include "pose/outline_levels.hpp"
#include "pose/outline_sizes.hpp"
#include "pose/pose.hpp"

namespace berth {

struct OutlineInput {
  const Camera& camera;
  const TargetModel& target;
  const ImageView& image;
  RigidTransform start;                // camera_from_target
  std::int32_t black, white;           // DN, rough
  std::int32_t noise_q8;               // sensor noise, one sigma, DN Q<8>; 0: unknown
  Mm blur_mm{0};                       // sigma on the plate, rough; 0: unknown
  ImageBlur last_blur = kUnknownBlur;  // of the frame before
  std::uint32_t most_steps = ~0u;      // of work
};

struct OutlineResult {
  Reason reason = Reason::kDegenerate;
  RigidTransform pose;                // camera_from_target
  PoseCovariance covariance;          // from the residuals' own variance
  Px residual_px;                     // rms displacement of segments that is left, weighted
  Q<16> residual_sigmas;              // rms grey residual over the sensor noise; 1: as predicted
  std::uint16_t markers_used = 0;     // bit per marker: dots, ring, line
  std::uint16_t markers_refused = 0;  // seen, but disturbed
  ImageBlur blur;
  EdgeOffset edge_offset;             // outwards, in sigma of the blur
  SizeEstimate sizes[kOutlineSizes];  // by OutlineSize
  bool has_wrong_size = false;        // one of them is not the target's
  std::int32_t noise_q8 = 0;          // rms residual, DN
  std::int32_t stations = 0, rejected = 0;
  std::uint32_t steps = 0;  // work done, about an instruction each
};

/// Scratch of refine_outlines, which begins its life anew.
struct OutlineWorkspace {
  OutlineLevels levels;
  OutlineNormal normal;
  SectorSums sector;
  BlurNormal blur;
  SectorBlur sector_blur;
  SectorEquations used[kMaxSectors];  // those that show their markers in even light
  int used_count;
  SectorShare shares[kMaxSectors];
  OutlineVertex traced[kMaxCoarseVertices];  // of long segments
  Q<16> place_by_px[kMaxSectors][2][2];      // of each sector's plane, mm per px
  std::uint16_t marker_stations[kMaxMarkers];
  std::uint16_t marker_rejected[kMaxMarkers];
};

/// At most ten rounds, and one for sizes; none is begun that does not fit `most_steps`. Reasons:
/// kNone, kDegenerate (too little undisturbed outline for a pose), kDeadline (a round that was
/// needed did not fit). Where it is not kNone only `steps` is to be used.
void refine_outlines(const OutlineInput& input, OutlineWorkspace& workspace, OutlineResult& result);

}  // namespace berth
