// The markers' share of the image: white minus black (or the reverse), blurred on a fine grid.
//
// An edge sampled at one cell a pixel before the blur would keep a trace of where the pixels lie.
// Markers are what estimators measure, so they are rendered at kCellsPerPixel cells a pixel and
// only then summed to pixels; the rest of the scene makes do with one cell a pixel.
#pragma once

#include "host_sim/render/convolve.hpp"
#include "host_sim/render/coverage.hpp"
#include "host_sim/render/light_field.hpp"

namespace berth::host {

inline constexpr int kCellsPerPixel = 4;

/// Memory that a sequence of frames reuses.
struct MarkerScratch {
  CoverageBuffer marker;
  CoverageBuffer cover;
  Plane moved, lanes, rows, tile;
  std::vector<float> light;
};

/// Adds every marker's share to `image`, whose pixel (0, 0) is the camera's.
void add_markers(const Scene& scene, const Camera& camera, const Target& target,
                 const LightField& light, MarkerScratch& scratch, Plane& image);

}  // namespace berth::host
