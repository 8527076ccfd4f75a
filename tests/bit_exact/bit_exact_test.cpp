// Host and emulated Cortex-M7 send the same packets, byte for byte, and reach the same digest at
// every stage.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <vector>

#include "host_sim/decode/decode.hpp"
#include "host_sim/io/camera_file.hpp"
#include "host_sim/io/target_file.hpp"
#include "host_sim/on_target/on_target.hpp"
#include "host_sim/parameters/build_block.hpp"
#include "runs.hpp"

namespace berth::host {
namespace {

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

// In the search, where no pose is left, and in the refinement, which leaves that of the dots.
TEST(BitExact, deadlines_strike_at_the_same_place_on_both) {
  auto frames = make_frame_set();
  frames.resize(24);
  int refinements_ended = 0;
  struct Budgets {
    std::int32_t search, frame;
  };
  for (const auto [search, frame_units] :
       {Budgets{0, 0}, {300, 600}, {2000, 4000}, {5500, 11000}, {5500, 6500}}) {
    SCOPED_TRACE(std::to_string(search) + ", " + std::to_string(frame_units));
    const Bytes block = block_with_budgets(search, frame_units);
    const auto host = decode_telemetry(run_on_host(frames, block));
    const auto target = decode_telemetry(run_in_qemu(frames, block));
    ASSERT_TRUE(host.has_value()) << host.error();
    ASSERT_TRUE(target.has_value()) << target.error();
    EXPECT_TRUE(host->vision_octets == target->vision_octets);
    int ended = 0;
    for (const FrameTelemetry& frame : host->frames) {
      const bool is_ended = frame.pose.reason == Reason::kDeadline;
      EXPECT_TRUE(search > 2000 || !frame.pose.valid);
      EXPECT_FALSE(is_ended && frame.pose.valid);
      ended += is_ended;
      refinements_ended += is_ended && frame.pose.identified;
    }
    EXPECT_GE(ended, 3);
  }
  EXPECT_GE(refinements_ended, 3);
}

// Every frame twice: the second search begins with the first one's pose.
TEST(BitExact, host_and_firmware_send_the_same_packets_when_they_track) {
  std::vector<NamedFrame> frames;
  const auto all = make_frame_set();
  for (std::size_t i = 0; i < all.size(); i += 4) frames.insert(frames.end(), 2, all[i]);
  const Bytes block = build_parameter_block(default_camera(), default_target(), {}, {true}).value();
  const auto host = decode_telemetry(run_on_host(frames, block));
  const auto target = decode_telemetry(run_in_qemu(frames, block));
  ASSERT_TRUE(host.has_value()) << host.error();
  ASSERT_TRUE(target.has_value()) << target.error();
  EXPECT_TRUE(host->vision_octets == target->vision_octets);
  int less_work = 0;
  for (std::size_t i = 1; i < host->frames.size(); i += 2) {
    less_work += host->frames[i].algorithm.work_units < host->frames[i - 1].algorithm.work_units;
  }
  EXPECT_GE(less_work, 8);
}

}  // namespace
}  // namespace berth::host
