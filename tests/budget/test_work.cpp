// The work that a frame is said to cost against the instructions that it takes, and the bound on
// any image.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "host_sim/budget/instruction_counts.hpp"
#include "host_sim/parameters/build_block.hpp"
#include "pipeline/parameters.hpp"

namespace berth::host {
namespace {

constexpr double kMillion = 1e6, kUnit = 1e3;

std::vector<FrameCount> counts_of(const std::vector<NamedFrame>& frames) {
  const auto block = build_parameter_block(default_camera(), default_target()).value();
  return count_instructions(frames, block, BERTH_FIRMWARE_BUILD "/berthmark.elf", [] {})
      .value()
      .frames;
}

TEST(Work, units_are_a_thousand_instructions_within_a_sixth) {
  double sum = 0, least = 10, most = 0;
  const auto counts = counts_of(envelope_frames(48, default_camera(), default_target()));
  for (const FrameCount& frame : counts) {
    const double ratio = frame.work_units * kUnit / frame.frame;
    sum += ratio;
    least = std::min(least, ratio);
    most = std::max(most, ratio);
  }
  const double mean = sum / static_cast<double>(counts.size());
  std::printf("units per thousand instructions: mean %.3f, %.3f .. %.3f\n", mean, least, most);
  EXPECT_NEAR(mean, 1.0, 0.05);
  EXPECT_GT(least, 5.0 / 6);
  EXPECT_LT(most, 7.0 / 6);
}

// Images without a target end within the search's budget, all within the frame's. Beyond it: what
// the units are wrong by, and what was begun last.
TEST(Work, any_image_ends_within_the_budget) {
  constexpr double kOverrun = 1.5e6, kWrong = 1.15;
  double worst = 0;
  for (const FrameCount& frame :
       counts_of(adversarial_frames(default_camera(), default_target()))) {
    const Thresholds defaults;
    const double budget =
        kUnit * (frame.identified ? defaults.frame_budget_units : defaults.search_budget_units);
    EXPECT_LT(frame.work_units * kUnit, budget + kOverrun) << frame.name;
    EXPECT_LT(frame.frame, kWrong * budget + kOverrun) << frame.name;
    if (!frame.identified) worst = std::max(worst, frame.frame);
  }
  std::printf("costliest image without a target: %.2f million instructions\n", worst / kMillion);
}

}  // namespace
}  // namespace berth::host
