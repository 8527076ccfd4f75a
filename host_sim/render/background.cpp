#include "host_sim/render/background.hpp"

#include <algorithm>

namespace berth::host {

void draw_background(const Scene& scene, const Camera&, const Target&, int, Plane& radiance) {
  const float level = static_cast<float>(scene.background.level_dn - scene.light.stray_dn);
  std::fill(radiance.data.begin(), radiance.data.end(), std::max(0.0f, level));
}

}  // namespace berth::host
