#include "host/board.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "hal/clock.hpp"
#include "hal/memory.hpp"
#include "hal/serial.hpp"
#include "hal/watchdog.hpp"

namespace berth::hal {
namespace {

FrameBuffers camera_buffers;
bool fill_second = false;
std::chrono::steady_clock::time_point clock_origin;

FrameStatus judge(const host::QueuedFrame& frame, std::size_t buffer_bytes) {
  if (frame.pixels.empty()) return FrameStatus::kUnreadable;
  const auto announced = std::int64_t{frame.width} * frame.height;
  const bool fits = announced == static_cast<std::int64_t>(frame.pixels.size()) &&
                    frame.pixels.size() <= buffer_bytes;
  return fits ? FrameStatus::kComplete : FrameStatus::kWrongByteCount;
}

}  // namespace

namespace host {

Board& board() {
  static Board the_board;
  return the_board;
}

}  // namespace host

bool camera_open(FrameBuffers buffers) {
  camera_buffers = buffers;
  fill_second = false;
  return host::board().has_camera;
}

CameraEvent camera_next_frame(CameraFrame& frame) {
  host::Board& board = host::board();
  if (board.frames.empty()) {
    return board.camera_fails_at_end ? CameraEvent::kDeviceError : CameraEvent::kEndOfStream;
  }
  const host::QueuedFrame queued = std::move(board.frames.front());
  board.frames.pop_front();
  const Span<std::uint8_t> buffer = fill_second ? camera_buffers.second : camera_buffers.first;
  fill_second = !fill_second;
  frame.status = judge(queued, buffer.size());
  frame.pixels = {};
  if (frame.status == FrameStatus::kComplete) {
    std::copy(queued.pixels.begin(), queued.pixels.end(), buffer.begin());
    frame.pixels = buffer.first(queued.pixels.size());
  }
  frame.width = queued.width;
  frame.height = queued.height;
  frame.index = queued.index;
  frame.mid_exposure_us = queued.mid_exposure_us;
  return CameraEvent::kFrame;
}

void serial_open() {}
void serial_write(Span<const std::uint8_t> bytes) {
  auto& line = host::board().line;
  line.insert(line.end(), bytes.begin(), bytes.end());
}

void clock_start() { clock_origin = std::chrono::steady_clock::now(); }
std::uint64_t clock_ticks() {
  const auto elapsed = std::chrono::steady_clock::now() - clock_origin;
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::microseconds>(elapsed).count());
}
std::uint32_t clock_rate_hz() { return 1000000; }

void watchdog_start(std::uint32_t) {}
void watchdog_service() {}

Span<const std::uint8_t> memory_parameter_block() { return host::board().parameter_block; }
std::uint32_t memory_stack_bytes() { return 0; }
std::uint32_t memory_stack_peak_bytes() { return 0; }

FaultRecord fault_take_record() { return std::exchange(host::board().fault, FaultRecord{}); }
std::uint32_t fault_boot_count() { return 1; }

}  // namespace berth::hal
