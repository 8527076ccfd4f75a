// What lies behind the target: space, a bright cloud, or the structure of a payload.
#pragma once

#include "host_sim/io/camera_model.hpp"
#include "host_sim/io/target_file.hpp"
#include "host_sim/render/convolve.hpp"
#include "host_sim/render/scene.hpp"

namespace berth::host {

/// Fills `radiance` (DN without stray light), whose cell (0, 0) is pixel (-margin, -margin).
void draw_background(const Scene& scene, const Camera& camera, const Target& target, int margin_px,
                     Plane& radiance);

}  // namespace berth::host
