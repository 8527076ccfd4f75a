// From radiance behind the optics to the noise-free signal.
#pragma once

#include "host_sim/render/convolve.hpp"
#include "host_sim/render/scene.hpp"

namespace berth::host {

/// Applies vignetting, stray light and gamma in place.
void respond(const Scene& scene, Plane& image);

}  // namespace berth::host
