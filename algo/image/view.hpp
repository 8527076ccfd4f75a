// A frame in external memory, seen through the target's polarity.
//
// The chain is written for white markers on black. For a black-on-white target every byte is read
// complemented (255 - v = v ^ 0xff), so nothing after this file knows of polarity.
#pragma once

#include <cstdint>

#include "core/check.hpp"

namespace berth {

constexpr int kMaxImageSide = 1024;

struct ImageView {
  const std::uint8_t* pixels = nullptr;  // row-major, 8 bit
  int width = 0;                         // pixels, at most kMaxImageSide
  int height = 0;
  int stride = 0;                  // bytes from row to row
  std::uint8_t polarity_mask = 0;  // 0x00 white on black, 0xff black on white

  /// Grey level with white markers bright, 0..255. (x, y) inside the image.
  int at(int x, int y) const {
    BERTH_RANGE(x >= 0 && x < width && y >= 0 && y < height);
    return pixels[y * stride + x] ^ polarity_mask;
  }
  const std::uint8_t* row(int y) const { return pixels + y * stride; }
  bool contains(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
};

}  // namespace berth
