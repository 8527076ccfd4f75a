// Stage 1b: linking edge pixels into chains that are one pixel wide and smooth.
//
// After Wen et al. 2017: from an anchor the chain takes, at every step, the strongest of the three
// neighbours ahead (the local optimum), where "ahead" is along the isophote at the current pixel.
// Each pixel is visited once: unlike Edge Drawing (Topal, Akinlar 2012) there is no second walk
// where the direction turns from horizontal to vertical, since the direction is the isophote's own
// and not one of two axes. The neighbours not taken are visited too, which keeps the chain one
// pixel wide. Where the strongest neighbour comes to nothing within two pixels (the ridge juts out
// at a corner), the walk goes on from the second strongest instead, and only then steps over a gap
// of a single pixel when the gradient goes on in its direction.
#pragma once

#include <cstdint>

#include "core/span.hpp"
#include "core/work.hpp"
#include "edge/edge_map.hpp"

namespace berth {

constexpr int kMinChainPixels = 6;

struct Chain {
  std::uint16_t start;  // first entry in ChainSet::order
  std::uint16_t count;  // pixels
};

/// Chains as runs of `order`, which lists edge-pixel indices. The bright side lies to the same hand
/// all along a chain (gradient = tangent turned by +90 degrees in image axes).
struct ChainSet {
  Span<std::uint16_t> order;    // storage: as many as edge pixels
  Span<std::uint16_t> row_of;   // storage: grid row of each edge pixel
  Span<std::uint32_t> visited;  // storage: one bit per edge pixel; afterwards: member of a chain
  Span<Chain> chains;           // storage
  int count = 0;
  int steps = 0;           // how often a walk stood on a pixel and looked ahead
  bool pool_full = false;  // further chains were dropped

  bool is_member(int i) const {
    return (visited[static_cast<std::size_t>(i >> 5)] >> (i & 31)) & 1u;
  }
};

/// Link the pixels of `map`. Chains shorter than kMinChainPixels or without an anchor (a pixel of
/// at least `anchor_threshold`) are dropped. Cost: about 260 instructions per edge pixel. Ends
/// early where `work` is spent, with the chains linked so far.
void link_edges(const EdgeMap& map, int anchor_threshold, ChainSet& set, Work& work);

}  // namespace berth
