#include "host_sim/on_target/frame_stream.hpp"

#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>

namespace berth::host {
namespace {

constexpr std::uint32_t kMagic = 0x4d414342;  // "BCAM"

void put32(std::uint32_t value, std::uint8_t* at) {
  for (int i = 0; i < 4; ++i) at[i] = static_cast<std::uint8_t>(value >> (8 * i));
}

bool write_all(int fd, const std::uint8_t* bytes, std::size_t size) {
  while (size > 0) {
    const ssize_t written = ::write(fd, bytes, size);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    bytes += written;
    size -= static_cast<std::size_t>(written);
  }
  return true;
}

// A reader that has gone shall be an error of write(), not the end of the program.
void block_pipe_signal() {
  sigset_t set;
  ::sigemptyset(&set);
  ::sigaddset(&set, SIGPIPE);
  ::pthread_sigmask(SIG_BLOCK, &set, nullptr);
}

}  // namespace

std::array<std::uint8_t, kStreamHeaderBytes> encode_stream_header(const TargetFrame& frame) {
  std::array<std::uint8_t, kStreamHeaderBytes> header{};
  put32(kMagic, &header[0]);
  put32(frame.index, &header[4]);
  put32(static_cast<std::uint32_t>(frame.mid_exposure_us), &header[8]);
  put32(static_cast<std::uint32_t>(frame.mid_exposure_us >> 32), &header[12]);
  put32(static_cast<std::uint32_t>(frame.width), &header[16]);
  put32(static_cast<std::uint32_t>(frame.height), &header[20]);
  put32(static_cast<std::uint32_t>(frame.pixels.size()), &header[24]);
  return header;
}

void write_frames(const TargetFrameSource& source, int fd) {
  block_pipe_signal();
  TargetFrame frame;
  while (source(frame)) {
    const auto header = encode_stream_header(frame);
    if (!write_all(fd, header.data(), header.size())) return;
    if (!write_all(fd, frame.pixels.data(), frame.pixels.size())) return;
    frame = TargetFrame{};
  }
}

}  // namespace berth::host
