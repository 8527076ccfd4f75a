// Runs frames through the firmware image in QEMU's mps2-an500 and collects what it sends.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "core/span.hpp"
#include "host_sim/on_target/frame_stream.hpp"

namespace berth::host {

/// Virtual time of one instruction under `-icount shift=0`, and so instructions per tick.
constexpr std::uint32_t kInstructionsPerSecond = 1000000000;

struct TargetOptions {
  std::string image;                     // the firmware's ELF file; empty: default_image_path()
  std::string qemu = "qemu-system-arm";  // searched in PATH
  int silence_timeout_s = 120;           // the run fails when nothing comes for so long
  /// Told of every portion of the line as it arrives, from the thread that started the run.
  std::function<void(Span<const std::uint8_t>)> on_bytes;
};

/// ../firmware/berthmark.elf as seen from the folder of the running program.
std::string default_image_path();

/// Starts the image with this parameter block, feeds it all frames and returns the bytes of the
/// serial line (decode_telemetry() takes them apart). Error: one line that says what is wrong and
/// what cures it. Memory: the line's bytes; frames are handed through one by one.
tl::expected<std::vector<std::uint8_t>, std::string> run_on_target(
    const TargetFrameSource& frames, Span<const std::uint8_t> parameter_block,
    const TargetOptions& options = {});

}  // namespace berth::host
