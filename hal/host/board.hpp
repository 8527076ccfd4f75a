// The board in a process: frames go in, the line's bytes come out. One board per process.
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "hal/camera.hpp"
#include "hal/fault.hpp"

namespace berth::hal::host {

/// A frame that the camera is going to deliver; any size, any number of pixels.
struct QueuedFrame {
  std::uint32_t index = 0;
  std::uint64_t mid_exposure_us = 0;
  std::int32_t width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
};

struct Board {
  std::vector<std::uint8_t> parameter_block;
  std::deque<QueuedFrame> frames;
  bool has_camera = true;
  bool camera_fails_at_end = false;  // instead of ending its stream
  FaultRecord fault;                 // what the boot before left
  std::vector<std::uint8_t> line;    // all that was sent
};

/// The board that the hal functions work on.
Board& board();

}  // namespace berth::hal::host
