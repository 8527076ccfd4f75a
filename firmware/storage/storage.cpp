#include "storage/storage.hpp"

namespace berth::storage {
namespace {

// On-chip data (.bss).
Parameters parameters;
Workspace workspace;
FrameResult result;
std::uint8_t line_bytes[kFrameLineBytes];
LineWriter line(line_bytes);

// External memory: written by the camera, read-only for the processor.
[[gnu::section(".external")]] std::uint8_t frames[2][hal::kFrameBufferBytes];

}  // namespace

ApplicationMemory application_memory() {
  return {parameters, workspace, result, line, {frames[0], frames[1]}};
}

}  // namespace berth::storage
