// Stage 2a: circle centres by isophote curvature (Lichtenauer 2005; Valenti, Gevers 2008).
//
// With the gradient g = (Lx, Ly) and the second derivative along the isophote
// Lvv = (Ly^2 Lxx - 2 Lx Ly Lxy + Lx^2 Lyy) / |g|^2, the isophote's curvature is -Lvv / |g| and its
// centre of curvature lies at p + D,
//   D = -g |g|^2 / (Ly^2 Lxx - 2 Lx Ly Lxy + Lx^2 Lyy) = -g / Lvv,   r = |g| / |Lvv|.
// Departure: Lvv and |g| are summed over a stretch of the linked chain before they are divided.
// Along a chain the noise of Lvv is strongly negatively correlated (it is a derivative along the
// chain), so the sum over n pixels loses noise like 1 / n, not 1 / sqrt(n), and large circles of
// low contrast still vote. The stretch is long where the isophote is nearly straight, short where
// it turns fast.
//
// Votes go into one accumulator per octave of radius, whose cells grow with the radius: the evolute
// of a tilted ring (half-width 0.4 to 0.5 semi-axes at 40 degrees) then fills few cells at any
// size. Every circle casts about 40 votes however large it is. Both edges of a ring vote for its
// centre.
#pragma once

#include <cstdint>

#include "core/span.hpp"
#include "core/work.hpp"
#include "edge/link.hpp"

namespace berth {

constexpr int kOctaves = 5;
constexpr int kVoteCells = 128 * 128 * 2 + 64 * 64 + 32 * 32 + 16 * 16;

struct VoteSpace {
  std::uint8_t cells[kVoteCells];  // saturating counts
  int scale_shift;                 // 1 on grids of more than 512 cells a side: all lengths double
  int votes;                       // cast in all
};

/// A place where votes meet, in grid cells.
struct CircleCandidate {
  std::int16_t x = 0, y = 0;    // centre
  std::int16_t radius_min = 0;  // the octave is radius_min .. 2 radius_min
  std::int16_t score = 0;       // votes in the 3 x 3 accumulator cells around
};

/// Let every chain vote, and leave each chain pixel's radius in place of its derivative. Cost:
/// about 230 instructions per chain pixel. Chains after `work` is spent do not vote.
void cast_votes(EdgeMap& map, const ChainSet& set, VoteSpace& space, Work& work);

/// The strongest local maxima, strongest first; returns how many, none where `work` is spent. Cost:
/// about 120 k instructions and 100 per occupied cell.
int find_candidates(const VoteSpace& space, Span<CircleCandidate> candidates, Work& work);

}  // namespace berth
