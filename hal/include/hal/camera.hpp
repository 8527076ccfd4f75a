// Camera: delivers 8-bit frames into external memory, one at a time.
//
// The device fills one of two frame buffers while the other is processed; software never writes
// them. A frame stays readable until the second call of camera_next_frame() after it.
#pragma once

#include <cstdint>

#include "core/span.hpp"

namespace berth::hal {

enum class FrameStatus : std::uint8_t {
  kComplete = 0,   // width * height bytes are in the buffer
  kUnreadable,     // the device announced a frame but has no picture for it
  kWrongByteCount  // bytes and size disagree, or do not fit a buffer
};

struct CameraFrame {
  Span<const std::uint8_t> pixels;     // row-major, stride = width; empty unless kComplete
  std::int32_t width = 0, height = 0;  // pixels, as announced by the device
  std::uint32_t index = 0;             // of the exposure, from 0
  std::uint64_t mid_exposure_us = 0;   // since the epoch of the packets' time
  FrameStatus status = FrameStatus::kUnreadable;
};

/// What a wait for the next frame ended with.
enum class CameraEvent : std::uint8_t { kFrame = 0, kEndOfStream, kDeviceError };

constexpr std::int32_t kFrameBufferBytes = 1024 * 1024;

/// Two buffers of external memory, each of kFrameBufferBytes, for the device to write.
struct FrameBuffers {
  Span<std::uint8_t> first, second;
};

/// Opens the device and hands it the buffers. False when there is none.
bool camera_open(FrameBuffers buffers);

/// Waits for the next frame. `frame` is written on kFrame only. No time-out: the watchdog is one.
CameraEvent camera_next_frame(CameraFrame& frame);

}  // namespace berth::hal
