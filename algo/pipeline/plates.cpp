#include "pipeline/plates.hpp"

#include "fixed/roots.hpp"

namespace berth {
namespace {

Vec2Px center_of(const SearchGrid& grid, const RingCandidate& ring) {
  return Vec2Px(grid.to_frame_x(ring.ellipse.cx), grid.to_frame_y(ring.ellipse.cy));
}

}  // namespace

PlateCircle plate_about(const TargetModel& target, const SearchGrid& grid,
                        const RingCandidate& ring) {
  const std::int64_t half_diagonal =
      hypot(target.plate_width_mm.raw(), target.plate_height_mm.raw()) / 2;
  const std::int64_t radius = ring.axes.major.raw() * half_diagonal / target.ring_outer_mm.raw();
  return {center_of(grid, ring), Px::saturated(radius * grid.bin)};
}

bool is_inside(const SearchGrid& grid, const RingCandidate& ring, const PlateCircle& plate) {
  const Vec2Px away = center_of(grid, ring) - plate.center_px;
  return std::int64_t{hypot(away[0].raw(), away[1].raw())} < plate.radius_px.raw();
}

bool NearMisses::cover(const SearchGrid& grid, const RingCandidate& ring) const {
  for (int k = 0; k < kMost && k < count_; ++k) {
    if (is_inside(grid, ring, plates_[k])) return true;
  }
  return false;
}

}  // namespace berth
