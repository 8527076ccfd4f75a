// What lies behind the target: space, a bright cloud, or the structure of a payload.
#pragma once

#include "host_sim/io/camera_model.hpp"
#include "host_sim/io/target_file.hpp"
#include "host_sim/render/painter.hpp"
#include "host_sim/render/scene.hpp"

namespace berth::host {

/// Memory that a sequence of frames reuses.
struct BackgroundScratch {
  Plane texture;
  CoverageBuffer coverage;
};

/// Fills `radiance` (DN without stray light), whose cell (0, 0) is pixel (-margin, -margin).
void draw_background(const Scene& scene, const Camera& camera, const Target& target, int margin_px,
                     BackgroundScratch& scratch, Plane& radiance);

}  // namespace berth::host
