// The driver that runs frames through the firmware in QEMU, and its errors.
#include "host_sim/on_target/on_target.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "host_sim/decode/decode.hpp"
#include "host_sim/io/camera_file.hpp"
#include "host_sim/io/target_file.hpp"
#include "host_sim/parameters/build_block.hpp"

namespace berth::host {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes default_block() { return build_parameter_block(default_camera(), default_target()).value(); }

TargetOptions with_flight_image() {
  TargetOptions options;
  options.image = BERTH_FIRMWARE_BUILD "/berthmark.elf";
  return options;
}

// `count` grey frames of a size; pixels as many as `bytes`.
TargetFrameSource grey_frames(std::uint32_t count, int side, std::size_t bytes) {
  return [next = 0u, count, side, pixels = Bytes(bytes, 77)](TargetFrame& frame) mutable {
    if (next == count) return false;
    frame.index = next++;
    frame.mid_exposure_us = frame.index * std::uint64_t{125000};
    frame.width = frame.height = side;
    frame.pixels = pixels;
    return true;
  };
}

constexpr std::size_t kFull = 1024 * 1024;

TEST(OnTarget, gives_bad_frame_for_every_kind_of_wrong_frame_and_goes_on) {
  struct Wrong {
    int side;
    std::size_t bytes;
  };
  const Bytes pixels(2048 * 2048, 77);
  std::size_t next = 0;
  const Wrong wrong[] = {{512, 512 * 512},    {1024, 0}, {1024, kFull - 1},
                         {2048, 2048 * 2048}, {0, 17},   {1024, kFull}};
  const auto frames = [&](TargetFrame& frame) {
    if (next == std::size(wrong)) return false;
    frame.index = static_cast<std::uint32_t>(next);
    frame.width = frame.height = wrong[next].side;
    frame.pixels = Span<const std::uint8_t>(pixels).first(wrong[next].bytes);
    ++next;
    return true;
  };
  const auto line = run_on_target(frames, default_block(), with_flight_image());
  ASSERT_TRUE(line.has_value()) << line.error();
  const auto telemetry = decode_telemetry(*line);
  ASSERT_TRUE(telemetry.has_value()) << telemetry.error();
  ASSERT_EQ(telemetry->frames.size(), std::size(wrong));
  for (std::size_t i = 0; i + 1 < std::size(wrong); ++i) {
    EXPECT_EQ(telemetry->frames[i].pose.reason, Reason::kBadFrame) << i;
  }
  EXPECT_NE(telemetry->frames.back().pose.reason, Reason::kBadFrame);
}

// The counter ticks once in 40 instructions, and where in a tick a frame begins depends on how long
// the serial line kept the program waiting: each reading is good to one tick. A
// stage of both looks is the sum of two.
TEST(OnTarget, counts_instructions_the_same_in_every_run) {
  const auto ticks = [&] {
    const auto line =
        run_on_target(grey_frames(2, 1024, kFull), default_block(), with_flight_image());
    const auto telemetry = decode_telemetry(line.value()).value();
    std::vector<std::uint32_t> all;
    for (const FrameTelemetry& frame : telemetry.frames) {
      all.push_back(frame.platform->frame_ticks);
      all.insert(all.end(), std::begin(frame.platform->stage_ticks),
                 std::end(frame.platform->stage_ticks));
      EXPECT_GT(frame.platform->frame_ticks, 0u);
      EXPECT_GT(frame.platform->stack_peak_bytes, 0u);
      EXPECT_LT(frame.platform->stack_peak_bytes, frame.platform->stack_bytes);
    }
    return all;
  };
  const std::vector<std::uint32_t> first = ticks(), second = ticks();
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_NEAR(double(first[i]), double(second[i]), 2.0) << i;
  }
}

TEST(OnTarget, says_what_the_firmware_refuses_about_the_parameters) {
  Bytes block = default_block();
  block[40] ^= 1;
  const auto line = run_on_target(grey_frames(1, 1024, kFull), block, with_flight_image());
  ASSERT_FALSE(line.has_value());
  EXPECT_EQ(line.error().find("the firmware refuses the parameter block: "), 0u) << line.error();
  EXPECT_FALSE(run_on_target(grey_frames(1, 1024, kFull), {}, with_flight_image()).has_value());
}

TEST(OnTarget, says_which_package_is_missing) {
  TargetOptions options = with_flight_image();
  options.qemu = "qemu-system-that-is-not-there";
  auto line = run_on_target(grey_frames(1, 8, 64), {}, options);
  ASSERT_FALSE(line.has_value());
  EXPECT_NE(line.error().find("apt-get install qemu-system-arm"), std::string::npos);
  options = with_flight_image();
  options.image = "/nowhere/berthmark.elf";
  line = run_on_target(grey_frames(1, 8, 64), {}, options);
  ASSERT_FALSE(line.has_value());
  EXPECT_NE(line.error().find("/nowhere/berthmark.elf"), std::string::npos);
  EXPECT_NE(line.error().find("gcc-arm-none-eabi"), std::string::npos);
}

TEST(OnTarget, gives_up_on_a_run_that_has_fallen_silent) {
  TargetOptions options = with_flight_image();
  options.silence_timeout_s = 1;
  const auto slow_camera = [](TargetFrame&) {
    std::this_thread::sleep_for(std::chrono::seconds(3));
    return false;
  };
  const auto line = run_on_target(slow_camera, default_block(), options);
  ASSERT_FALSE(line.has_value());
  EXPECT_EQ(line.error(), "the firmware in QEMU sent nothing for 1 s");
}

TEST(OnTarget, says_what_qemu_says_when_it_does_not_start) {
  TargetOptions options = with_flight_image();
  options.qemu = "sleep";  // a program that refuses QEMU's options
  const auto line = run_on_target(grey_frames(1, 1024, kFull), {}, options);
  ASSERT_FALSE(line.has_value());
  EXPECT_NE(line.error().find("ended with code 1: sleep: invalid option"), std::string::npos)
      << line.error();
}

}  // namespace
}  // namespace berth::host
