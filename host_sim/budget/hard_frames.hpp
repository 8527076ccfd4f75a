// Frames on which instructions are counted: the envelope's, and images made to be expensive.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "host_sim/io/camera_file.hpp"
#include "host_sim/io/target_file.hpp"

namespace berth::host {

struct NamedFrame {
  std::string name;
  cv::Mat image;
};

/// The first `count` frames of the campaign's envelope set, seed 1.
std::vector<NamedFrame> envelope_frames(int count, const Camera& camera, const Target& target);

/// Scenes of the envelope at this distance.
std::vector<NamedFrame> frames_at(double distance_mm, int count, const Camera& camera,
                                  const Target& target);

/// Noise of every strength, checkerboards, gratings, rings over the whole image, lattices of rings,
/// a hundred near-miss targets, black, white, and the worst of them above a half of a frame with a
/// target.
std::vector<NamedFrame> adversarial_frames(const Camera& camera, const Target& target);

}  // namespace berth::host
