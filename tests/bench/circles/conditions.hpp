// Groups of scenes, each with one difficulty.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host_sim/render/random.hpp"
#include "host_sim/render/sample_scene.hpp"

namespace berth::bench {

struct Condition {
  std::string name;
  host::SceneOptions options;                                      // what is fixed for all scenes
  std::function<void(host::Random&, host::SceneOptions&)> choose;  // before the scene is drawn
  std::function<void(host::Random&, const host::Target&, host::Scene&)> change;  // afterwards
};

std::vector<Condition> all_conditions();

/// Scene `index` of a condition; everything else is drawn as over the envelope.
host::Scene make_scene(const Condition& condition, std::uint64_t index, const host::Camera& camera,
                       const host::Target& target);

}  // namespace berth::bench
