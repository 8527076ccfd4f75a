// Stage 2a: arcs, the stretches of chains that turn about something bright.
//
// Isophote curvature summed along a chain is the angle by which the gradient turns. Summed over a
// whole stretch it needs no second derivative and holds at any tilt: an ellipse turns through
// 360 degrees however flat it is, while its votes spread over an evolute that outgrows it (1.5
// semi-axes at 60 degrees). A chain is cut where it turns back by more than kTurnBack, as a ring's
// outline does where something dark lies over it, and at corners, as at the ends of a ring that is
// cut; each stretch that turns far enough is fitted with an ellipse. Outlines broken into shorter
// pieces are left to the votes (votes.hpp).
#pragma once

#include <cstdint>

#include "circle/ellipse.hpp"
#include "core/span.hpp"
#include "core/work.hpp"
#include "edge/link.hpp"

namespace berth {

constexpr int kFullTurn = 32;                  // steps of turn, 11.25 degrees each
constexpr int kWholeTurn = kFullTurn * 7 / 8;  // about nearly all of an outline
constexpr int kTurnBack = 3;                   // noise moves the direction by a step to either side
constexpr int kMinTurn = 11;                   // shorter arcs do not determine an ellipse
constexpr int kMinArcPixels = 16;

/// A stretch of ChainSet::order that turns by `turn` steps about its bright side.
struct Arc {
  std::uint16_t start = 0, count = 0;
  std::int16_t turn = 0;
};

/// Direction of a gradient in steps of kFullTurn, from x towards y. Cost: about 30 instructions.
int direction_of(int gx, int gy);

/// The arcs that turn furthest, furthest first (of equal ones the earlier); returns how many: none
/// of the chains after `work` is spent.
/// Cost: about 60 instructions per chain pixel.
int find_arcs(const EdgeMap& map, const ChainSet& set, Span<Arc> arcs, Work& work);

/// The ellipse through an arc. False when it determines none, or one far larger than the arc.
/// Cost: about 4 k instructions and 90 per point, 64 points at most.
bool fit_arc(const EdgeMap& map, const ChainSet& set, const Arc& arc, Ellipse& ellipse, Work& work);

}  // namespace berth
