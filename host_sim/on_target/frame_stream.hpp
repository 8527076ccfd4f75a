// The camera's end of the line to the emulated board: frames as the records that
// hal/mps2_an500/camera.cpp reads.
#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include "core/span.hpp"

namespace berth::host {

/// A frame for the target. Any size is legal: the firmware says what it thinks of it.
struct TargetFrame {
  std::uint32_t index = 0;
  std::uint64_t mid_exposure_us = 0;
  std::int32_t width = 0, height = 0;
  Span<const std::uint8_t> pixels;  // row by row; empty for an image that could not be read
};

/// Hands out the next frame, false when there are no more. The pixels stay valid until the next
/// call. Called from one thread, which is not the one that started the run.
using TargetFrameSource = std::function<bool(TargetFrame& frame)>;

constexpr std::size_t kStreamHeaderBytes = 32;
std::array<std::uint8_t, kStreamHeaderBytes> encode_stream_header(const TargetFrame& frame);

/// Writes all frames to a pipe. Returns early when the reader has gone.
void write_frames(const TargetFrameSource& source, int fd);

}  // namespace berth::host
