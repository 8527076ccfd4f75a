// Which frame stands where in a campaign: four sets, each a sequence of which every prefix is a
// valid sample, and whose frame `index` depends on the seed only.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "host_sim/campaign/near_miss.hpp"
#include "host_sim/campaign/photo_crops.hpp"
#include "host_sim/render/render.hpp"
#include "host_sim/render/scene.hpp"

namespace berth::host {

enum class CampaignSet {
  kEnvelope,  ///< the operating envelope
  kSteep,     ///< tilt 40 to 60 degrees, the whole line visible
  kHidden,    ///< a dot, a quarter of the ring or half of the line hidden in every frame
  kEmpty,     ///< no target: near misses at even indices, photographs at odd ones
};

/// What a frame shows.
struct CampaignFrame {
  std::string kind;     ///< "target", "photo", or the near miss's name
  double amount = 0;    ///< of the near miss
  double shift_px = 0;  ///< how far the change moves an outline in the image, at most
  Scene scene;          ///< without meaning for photographs
  Image8 image;
};

/// Scene of the steep set: as the envelope's, but tilted by 40 to 60 degrees and turned so that
/// neither collar nor post nor occluder hides any part of the line.
Scene steep_scene(uint64_t seed, uint64_t index, const Camera& camera, const Target& target);

/// Whether a raised dot's collar or post hides a part of the line.
bool is_line_covered(const Pose& pose, const Camera& camera, const Target& target);

class FrameMaker {
 public:
  /// `photos` is needed for kEmpty only.
  FrameMaker(CampaignSet set, uint64_t seed, Camera camera, Target target,
             std::optional<PhotoLibrary> photos);

  CampaignFrame make(uint64_t index) const;

 private:
  Scene scene_with_target(uint64_t index) const;
  CampaignFrame near_miss(uint64_t index) const;
  CampaignFrame photo(uint64_t index) const;

  CampaignSet set_;
  uint64_t seed_;
  Camera camera_;
  Target target_;
  std::optional<PhotoLibrary> photos_;
};

}  // namespace berth::host
