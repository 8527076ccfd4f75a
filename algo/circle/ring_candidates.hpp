// Stage 2c: from an arc, or a place where votes meet, to the outline of a bright disc: gather, fit,
// repeat.
//
// Arcs and votes propose, an ellipse fit on the chains decides. An arc brings an ellipse of its
// own. From votes, starting from a circle of the candidate's octave, chain pixels whose gradient
// points to the centre are gathered, the best-covered band of radii is taken, and an ellipse is
// fitted; then pixels near that ellipse whose gradient is its inward normal, with a gate that
// narrows from fit to fit. What counts in the end is the share of the outline that is covered by
// such pixels.
#pragma once

#include "circle/arcs.hpp"
#include "circle/ellipse.hpp"
#include "circle/votes.hpp"
#include "edge/link.hpp"

namespace berth {

constexpr int kSectors = 32;       // of the outline, for its coverage
constexpr int kWholeSectors = 28;  // an outline with all of them but the odd one is not cut

struct RingCandidate {
  Ellipse ellipse;
  EllipseAxes axes;
  std::int16_t covered = 0;  // sectors of kSectors with an edge pixel on the outline
  std::int16_t pixels = 0;   // edge pixels on the outline
};

/// Fit the outline of a bright disc to `candidate`. False when no ellipse of at least
/// `min_covered` sectors comes out. Cost: about 20 instructions per edge pixel in its surroundings
/// and fit, six fits at most. False as well where `work` is spent on the way, here and below.
bool fit_ring(const EdgeMap& map, const ChainSet& set, const CircleCandidate& candidate,
              int min_covered, RingCandidate& ring, Work& work);

/// The same for an arc, starting from its own ellipse: three fits, and as many for each two thirds
/// of it when the outline is not whole.
bool fit_ring(const EdgeMap& map, const ChainSet& set, const Arc& arc, int min_covered,
              RingCandidate& ring, Work& work);

/// Does the arc lie on an outline already found? Five places along it are looked at.
bool is_explained(const EdgeMap& map, const ChainSet& set, const Arc& arc,
                  const RingCandidate& ring);

/// Is the candidate's place and octave that of a whole outline already found (within a quarter of
/// it)?
bool is_explained(const CircleCandidate& candidate, const RingCandidate& ring);

/// Do two outlines agree within an eighth of their size?
bool is_same_ring(const RingCandidate& a, const RingCandidate& b);

}  // namespace berth
