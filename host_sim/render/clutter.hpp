// The structure of a payload around the target: panels, rings, discs, bars, bolts, holes, cables,
// crumpled foil, reflections.
#pragma once

#include "host_sim/io/target_file.hpp"
#include "host_sim/render/painter.hpp"
#include "host_sim/render/payload_plane.hpp"

namespace berth::host {

/// What the parts of one scene have in common.
struct ClutterStyle {
  double level_dn = 100;  ///< a middle grey of the structure
  double angle_rad = 0;   ///< its main direction in the payload's plane
  double density = 1;     ///< relative number of parts
};

/// Paints the whole plane; what lies near the target reaches up to and under the plate's border.
void draw_clutter(uint64_t seed, double level_dn, const PayloadPlane& plane, const Target& target,
                  Painter& painter);

}  // namespace berth::host
