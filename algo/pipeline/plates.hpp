// Where the plates about rings lie in the frame, and which of them were no target's.
#pragma once

#include "circle/ring_candidates.hpp"
#include "image/search_grid.hpp"
#include "target/model.hpp"

namespace berth {

/// The circle about a plate, whose own edges and dots have their centres in it. Frame pixels.
struct PlateCircle {
  Vec2Px center_px{Px(0), Px(0)};
  Px radius_px;
};

/// `ring` was found on `grid`.
PlateCircle plate_about(const TargetModel& target, const SearchGrid& grid,
                        const RingCandidate& ring);
bool is_inside(const SearchGrid& grid, const RingCandidate& ring, const PlateCircle& plate);

/// The last plates that outlines refuted.
class NearMisses {
 public:
  void add(const PlateCircle& plate) { plates_[count_++ % kMost] = plate; }
  bool cover(const SearchGrid& grid, const RingCandidate& ring) const;

 private:
  static constexpr int kMost = 4;
  PlateCircle plates_[kMost] = {};
  int count_ = 0;
};

}  // namespace berth
