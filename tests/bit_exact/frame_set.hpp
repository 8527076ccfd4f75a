// Frames on which host and target are compared: renders over the whole envelope, with and without
// the target, and frames made to fill pools, to saturate and to fail.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace berth::host {

struct NamedFrame {
  std::string name;
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;  // empty: an image that could not be read
};

/// 48 renders over the envelope, 8 without the target, 6 clean ones, 10 adversarial frames and 4
/// that are no picture of the camera. The same in every run.
std::vector<NamedFrame> make_frame_set();

}  // namespace berth::host
