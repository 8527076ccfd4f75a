// Where an edge pixel's edge is.
#pragma once

#include "edge/edge_map.hpp"

namespace berth {

/// A place in the grid, 1/64 cell.
struct Place {
  std::int32_t x, y;
};

/// An edge pixel's place, sub-cell offset included; `y` is its row.
inline Place place_of(const EdgePixel& p, int y) {
  Place at{p.x() * 64, y * 64};
  (p.is_steep_in_x() ? at.x : at.y) += p.offset();
  return at;
}

}  // namespace berth
