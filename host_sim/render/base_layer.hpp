// The scene without its markers: background, bare plate, collars and posts, occluders, glints.
#pragma once

#include "host_sim/render/background.hpp"
#include "host_sim/render/light_field.hpp"

namespace berth::host {

/// Memory that a sequence of frames reuses.
struct BaseScratch {
  Plane radiance;
  Plane moved, lanes, rows;
  BackgroundScratch background;
  std::vector<float> light;
};

/// How far beyond the image the scene is drawn, since blur brings it in.
int margin_of(const Optics& optics);

/// The blurred radiance, without stray light, in `image` (the camera's size).
void render_base(const Scene& scene, const Camera& camera, const Target& target,
                 const LightField& light, BaseScratch& scratch, Plane& image);

}  // namespace berth::host
