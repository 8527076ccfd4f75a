#include "host_sim/render/scene.hpp"

#include <algorithm>

namespace berth::host {

double Scene::contrast_dn() const {
  const auto darkest = [this](double level_dn) {
    const double lit = light.stray_dn + (level_dn - light.stray_dn) / light.gradient_ratio;
    return std::min(255.0, lit);
  };
  return darkest(light.white_dn) - darkest(light.black_dn);
}

std::string Scene::hidden_marker() const {
  return occluders.empty() ? std::string() : occluders.front().marker;
}

}  // namespace berth::host
