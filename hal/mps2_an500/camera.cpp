// Camera of the emulated board: a stream of frames in a host file or pipe, whose name is the
// second word of the semihosting command line. The host writes the frame buffers as a camera's DMA
// would; to the processor they are read-only.
//
// Stream: records of 32 bytes, little-endian, each followed by its pixels (docs/interfaces.md):
//   u32 magic "BCAM", u32 index, u64 mid-exposure in us, u32 width, u32 height, u32 bytes, u32 zero
#include "hal/camera.hpp"

#include "mps2_an500/semihosting.hpp"

namespace berth::hal {
namespace {

constexpr std::uint32_t kMagic = 0x4d414342;  // "BCAM"
constexpr std::int32_t kMaxSide = 65535;

struct StreamHeader {
  std::uint32_t magic, index, time_low, time_high, width, height, bytes, zero;
};
static_assert(sizeof(StreamHeader) == 32);

struct Device {
  FrameBuffers buffers;
  std::int32_t handle = -1;
  bool fill_second = false;
};
Device device;

// All `bytes` of the stream into `to`, in as many portions as the host hands out.
bool read_all(std::uint8_t* to, std::uint32_t bytes) {
  std::uint32_t missing = bytes;
  while (missing > 0) {  // each turn takes at least one byte
    const std::uint32_t block[3] = {
        static_cast<std::uint32_t>(device.handle),
        static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(to + (bytes - missing))),
        missing};
    const std::int32_t left = semihosting::call(semihosting::Call::kRead, block);
    if (left < 0 || static_cast<std::uint32_t>(left) >= missing) return false;
    missing = static_cast<std::uint32_t>(left);
  }
  return true;
}

// Reads what the record announces, in portions of a buffer where it is larger than that.
bool drain(std::uint32_t bytes, Span<std::uint8_t> buffer) {
  const auto portion = static_cast<std::uint32_t>(buffer.size());
  for (std::uint32_t left = bytes; left > 0;) {  // at most 2^32 / portion turns
    const std::uint32_t now = left < portion ? left : portion;
    if (!read_all(buffer.data(), now)) return false;
    left -= now;
  }
  return true;
}

FrameStatus judge(const StreamHeader& header, std::size_t buffer_bytes) {
  if (header.bytes == 0) return FrameStatus::kUnreadable;
  const bool fits = header.width <= kMaxSide && header.height <= kMaxSide &&
                    header.bytes == header.width * header.height && header.bytes <= buffer_bytes;
  return fits ? FrameStatus::kComplete : FrameStatus::kWrongByteCount;
}

const char* second_word(char* line, std::int32_t capacity) {
  std::int32_t start = 0;
  for (std::int32_t i = 0; i < capacity && line[i] != '\0'; ++i) {
    if (line[i] != ' ') continue;
    if (start != 0) {
      line[i] = '\0';
      break;
    }
    start = i + 1;
  }
  return start == 0 ? nullptr : line + start;
}

}  // namespace

bool camera_open(FrameBuffers buffers) {
  char line[256] = {};
  const std::uint32_t line_block[2] = {
      static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(line)), sizeof line - 1};
  if (semihosting::call(semihosting::Call::kGetCommandLine, line_block) != 0) return false;
  const char* name = second_word(line, sizeof line);
  if (name == nullptr) return false;
  std::uint32_t length = 0;
  while (name[length] != '\0') ++length;  // `line` ends with a zero
  constexpr std::uint32_t kReadBinary = 1;
  const std::uint32_t open_block[3] = {
      static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(name)), kReadBinary, length};
  device.buffers = buffers;
  device.fill_second = false;
  device.handle = semihosting::call(semihosting::Call::kOpen, open_block);
  return device.handle >= 0;
}

CameraEvent camera_next_frame(CameraFrame& frame) {
  if (device.handle < 0) return CameraEvent::kDeviceError;
  alignas(4) std::uint8_t octets[sizeof(StreamHeader)];
  if (!read_all(octets, sizeof octets)) return CameraEvent::kEndOfStream;
  StreamHeader header;
  __builtin_memcpy(&header, octets, sizeof header);
  if (header.magic != kMagic) return CameraEvent::kDeviceError;
  const Span<std::uint8_t> buffer =
      device.fill_second ? device.buffers.second : device.buffers.first;
  if (!drain(header.bytes, buffer)) return CameraEvent::kDeviceError;
  device.fill_second = !device.fill_second;
  frame.status = judge(header, buffer.size());
  const bool complete = frame.status == FrameStatus::kComplete;
  frame.pixels =
      complete ? Span<const std::uint8_t>(buffer.first(header.bytes)) : Span<const std::uint8_t>();
  frame.width = static_cast<std::int32_t>(header.width);
  frame.height = static_cast<std::int32_t>(header.height);
  frame.index = header.index;
  frame.mid_exposure_us = std::uint64_t{header.time_high} << 32 | header.time_low;
  return CameraEvent::kFrame;
}

}  // namespace berth::hal
