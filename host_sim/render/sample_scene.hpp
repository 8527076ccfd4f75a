// Scenes of the operating envelope, as a low-discrepancy sequence.
//
// Scene `index` depends on the seed and the options only, not on how many are drawn, and every
// prefix of the sequence is a valid sample of the envelope.
#pragma once

#include <optional>

#include "host_sim/io/camera_model.hpp"
#include "host_sim/io/target_file.hpp"
#include "host_sim/render/scene.hpp"

namespace berth::host {

struct SceneOptions {
  uint64_t seed = 0;
  bool clean = false;       ///< white 200, black 30, noise 2, blur 0.7 px, even light, plain grey
  bool with_target = true;  ///< false: the very same scene without the target
  std::optional<double> distance_mm;
  std::optional<double> tilt_deg;
  std::optional<double> tilt_direction_deg;
  std::optional<double> roll_deg;
  double share_occluded = 0.20;  ///< of the scenes, in which something hides a marker
};

/// The distances of the envelope for this target: 300 to 1500 mm for a plate of 120 mm, in
/// proportion for others.
struct DistanceRange {
  double nearest_mm;
  double farthest_mm;
};
DistanceRange distance_range(const Target& target);

/// Draws one scene. Where the target cannot lie wholly in the image, is_plate_inside is false.
Scene sample_scene(const SceneOptions& options, uint64_t index, const Camera& camera,
                   const Target& target);

/// A clean scene at a given pose: white 200, black 30, noise 2, blur 0.7 px, even light, plain
/// grey.
Scene clean_scene(const Pose& pose);

}  // namespace berth::host
