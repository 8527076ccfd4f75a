// Stage 1a: edge pixels, the local maxima of the gradient magnitude.
//
// A pixel is kept when its magnitude |gx| + |gy| exceeds the threshold and is a maximum along the
// gradient's dominant axis (edge/ridges.hpp). The sub-cell offset is the vertex of the
// parabola through the three magnitudes (Devernay 1995, along the dominant axis). The isophote's
// second derivative Lvv = (gy^2 Lxx - 2 gx gy Lxy + gx^2 Lyy) / (gx^2 + gy^2) is taken here, while
// the gradients of the neighbour rows are at hand; the circle stage turns it into curvature.
//
// A full pool keeps the strongest edges: the threshold rises until at least a quarter of the pool
// is free, and weaker pixels that are already stored are dropped. So the pool's bound never depends
// on where in the image the edges are, and the outcome is that of the higher threshold from the
// start.
#pragma once

#include <cstdint>

#include "core/work.hpp"
#include "edge/edge_map.hpp"
#include "image/gradient_rows.hpp"

namespace berth {

struct DetectOutcome {
  int threshold = 0;       // the one that was in force at the end
  bool pool_full = false;  // it had to rise
};

/// Threshold for a given sensor noise (DN, Q8): `sigmas` (Q16) standard deviations of one gradient
/// component, but no less than the weakest edge of the operating envelope needs.
int edge_threshold(std::uint16_t noise_q8, Q<16> sigmas, int bin);

/// Fill `map` with the edge pixels of `grid`. `rows` is scratch. map.pixels and map.block_start are
/// the caller's storage. Cost: about 20 instructions per cell, 110 per edge pixel. Ends early where
/// `work` is spent, with the rows done so far.
DetectOutcome detect_edges(const ImageView& image, const SearchGrid& grid, int threshold,
                           GradientRows& rows, EdgeMap& map, Work& work);

}  // namespace berth
