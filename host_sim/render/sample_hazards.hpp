// What befalls a target: an occlusion, a shadow's edge, a glint.
#pragma once

#include "host_sim/io/target_file.hpp"
#include "host_sim/render/scene.hpp"
#include "host_sim/render/sobol.hpp"

namespace berth::host {

/// `share_occluded` of the scenes get one occlusion (a dot, a quarter of the ring or half of the
/// line), 20 % a shadow edge across a marker, 20 % a glint on the plate; the scene's light must be
/// drawn before.
void sample_hazards(const SobolPoint& point, double share_occluded, const Target& target,
                    Scene& scene);

/// Hides half of the line; side +1 or -1 along it.
Occluder occlude_line(const Line& line, int side);

/// Hides a quarter of the ring from `start_rad` on.
Occluder occlude_ring(const Ring& ring, double start_rad);

/// Hides a dot behind a square turned by `angle_rad`.
Occluder occlude_dot(const Dot& dot, double angle_rad);

}  // namespace berth::host
