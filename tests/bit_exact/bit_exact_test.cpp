// Host and emulated Cortex-M7 send the same packets, byte for byte, and reach the same digest at
// every stage.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <vector>

#include "app/parameter_block.hpp"
#include "app/vision_task.hpp"
#include "frame_set.hpp"
#include "host_sim/decode/decode.hpp"
#include "host_sim/io/camera_file.hpp"
#include "host_sim/io/target_file.hpp"
#include "host_sim/on_target/on_target.hpp"
#include "host_sim/parameters/build_block.hpp"

namespace berth::host {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint64_t kPeriod_us = 125000;

Bytes run_on_host(const std::vector<NamedFrame>& frames, const Bytes& block) {
  Parameters parameters;
  EXPECT_TRUE(decode_parameter_block(block, parameters).is_ok());
  const auto workspace = std::make_unique<Workspace>();
  const auto result = std::make_unique<FrameResult>();
  Bytes buffer(kFrameLineBytes), all;
  LineWriter line(buffer);
  VisionTask task(parameters, {*workspace, *result, line});
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const NamedFrame& named = frames[i];
    hal::CameraFrame frame;
    frame.index = static_cast<std::uint32_t>(i);
    frame.mid_exposure_us = i * kPeriod_us;
    frame.width = named.width;
    frame.height = named.height;
    const auto announced = static_cast<std::size_t>(named.width) * named.height;
    if (announced == named.pixels.size() && announced <= hal::kFrameBufferBytes) {
      frame.status = hal::FrameStatus::kComplete;
      frame.pixels = named.pixels;
    }
    const auto bytes = task.on_frame(frame);
    all.insert(all.end(), bytes.begin(), bytes.end());
  }
  return all;
}

Bytes run_in_qemu(const std::vector<NamedFrame>& frames, const Bytes& block) {
  TargetOptions options;
  options.image = BERTH_FIRMWARE_BUILD "/berthmark.elf";
  std::size_t next = 0;
  const auto source = [&](TargetFrame& frame) {
    if (next == frames.size()) return false;
    frame.index = static_cast<std::uint32_t>(next);
    frame.mid_exposure_us = next * kPeriod_us;
    frame.width = frames[next].width;
    frame.height = frames[next].height;
    frame.pixels = frames[next].pixels;
    ++next;
    return true;
  };
  const auto line = run_on_target(source, block, options);
  EXPECT_TRUE(line.has_value()) << line.error();
  return line ? *line : Bytes{};
}

// Median and worst of one figure of the platform packets, in millions of instructions.
template <typename Ticks>
void print_instructions(const char* name, const Telemetry& target, Ticks ticks) {
  std::vector<double> counts;
  for (const FrameTelemetry& frame : target.frames) {
    const PlatformPacket& platform = frame.platform.value();
    const double per_tick = kInstructionsPerSecond / static_cast<double>(platform.ticks_hz);
    counts.push_back(ticks(platform) * per_tick / 1e6);
  }
  std::sort(counts.begin(), counts.end());
  std::printf("%-10s %8.2f %8.2f\n", name, counts[counts.size() / 2], counts.back());
}

void print_platform(const Telemetry& target) {
  std::printf("million instructions: median, worst\n");
  for (int s = 0; s < kStageCount; ++s) {
    print_instructions(stage_name(static_cast<Stage>(s)), target,
                       [s](const PlatformPacket& p) { return p.stage_ticks[s]; });
  }
  print_instructions("frame", target, [](const PlatformPacket& p) { return p.frame_ticks; });
  const PlatformPacket& last = target.frames.back().platform.value();
  std::printf("stack peak %u of %u bytes\n", last.stack_peak_bytes, last.stack_bytes);
}

TEST(BitExact, host_and_firmware_send_the_same_packets) {
  const auto frames = make_frame_set();
  const Bytes block = build_parameter_block(default_camera(), default_target()).value();
  const auto host = decode_telemetry(run_on_host(frames, block));
  const auto target = decode_telemetry(run_in_qemu(frames, block));
  ASSERT_TRUE(host.has_value()) << host.error();
  ASSERT_TRUE(target.has_value()) << target.error();
  ASSERT_EQ(host->frames.size(), frames.size());
  ASSERT_EQ(target->frames.size(), frames.size());
  int poses = 0, failures = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const AlgorithmPacket& here = host->frames[i].algorithm;
    const AlgorithmPacket& there = target->frames[i].algorithm;
    for (int s = 0; s < kStageCount; ++s) {
      EXPECT_EQ(here.digests[s], there.digests[s])
          << frames[i].name << ", stage " << stage_name(static_cast<Stage>(s));
    }
    (host->frames[i].pose.valid ? poses : failures) += 1;
  }
  EXPECT_TRUE(host->vision_octets == target->vision_octets);
  std::printf("%d frames with a valid pose, %d with a reason\n", poses, failures);
  EXPECT_GE(poses, 20);
  EXPECT_GE(failures, 20);
  print_platform(*target);
}

}  // namespace
}  // namespace berth::host
