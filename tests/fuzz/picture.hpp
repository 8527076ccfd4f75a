// Fuzz input as a picture: bytes are drawing commands, so that a fuzzer reaches the deep stages.
//
// Header of 8 octets: image size, target, background, noise, blur. Then commands of 16 octets:
// shapes, gradients, raw pixels, and the target itself in any pose, of which later commands destroy
// what they like. Missing octets count as zero; the result depends on the bytes only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pipeline/parameters.hpp"

namespace berth::fuzz {

struct Picture {
  Parameters parameters;
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
};

Picture decode_picture(const std::uint8_t* data, std::size_t size);

}  // namespace berth::fuzz
