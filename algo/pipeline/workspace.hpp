// All memory that the chain needs beside the frame: the caller owns it, once, statically.
//
// What a frame leaves behind is its trace: edges, chains, candidates and rings, for whoever wants
// to draw them. Line buffers, votes and the outline's scratch never live at the same time and share
// their place.
#pragma once

#include "circle/ring_candidates.hpp"
#include "circle/votes.hpp"
#include "edge/detect.hpp"
#include "edge/link.hpp"
#include "image/gradient_rows.hpp"
#include "image/search_grid.hpp"
#include "pose/outline.hpp"
#include "target/identify.hpp"

namespace berth {

constexpr int kMaxEdgePixels = 16384;  // a cluttered frame has some 9000 on the binned grid
constexpr int kMaxChains = 2048;
constexpr int kMaxCircleCandidates = 32;
constexpr int kMaxArcs = 48;
constexpr int kMaxRings = 48;
constexpr int kMaxGridRows = 512;

struct Workspace {
  Workspace() : rows() {}

  EdgePixel edge_pixels[kMaxEdgePixels];
  std::uint16_t block_start[kMaxGridRows * kBlocksPerRow + 1];
  std::uint16_t chain_order[kMaxEdgePixels];
  std::uint16_t chain_rows[kMaxEdgePixels];
  std::uint32_t edge_marks[kMaxEdgePixels / 32];
  Chain chains[kMaxChains];
  union {
    GradientRows rows;
    VoteSpace votes;
    OutlineWorkspace outline;
  };

  // The trace of the last frame.
  SearchGrid grid;
  EdgeMap map;
  ChainSet set;
  Arc arcs[kMaxArcs];
  int arc_count;
  CircleCandidate candidates[kMaxCircleCandidates];
  int candidate_count;
  RingCandidate rings[kMaxRings];
  int ring_count;
  Identification identification;  // of the accepted ring, or of the one that came closest
};

}  // namespace berth
