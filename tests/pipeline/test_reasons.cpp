// Every reason is provoked by an image, or it is said here why none can.
#include <gtest/gtest.h>

#include <random>

#include "chain_tools.hpp"
#include "host_sim/campaign/near_miss.hpp"

namespace berth::test {
namespace {

using host::Target;

void expect_reason(const FrameResult& result, Reason expected) {
  EXPECT_EQ(result.reason, expected) << "reason: " << reason_name(result.reason);
  EXPECT_EQ(result.valid, expected == Reason::kNone);
}

FrameResult look(const host::Scene& scene, const Target& target = host::default_target()) {
  return process(host::render_frame(scene, host::default_camera(), target), host::default_camera(),
                 target);
}

TEST(Reasons, None) { expect_reason(look(host::clean_scene(pose_at(500, 20, 20))), Reason::kNone); }

TEST(Reasons, BadFrame) {
  host::Image8 image = painted([](int, int) { return 100; });
  image.width = 512;
  expect_reason(process(image), Reason::kBadFrame);
}

TEST(Reasons, LowContrastWithoutAnyEdge) {
  expect_reason(process(painted([](int, int) { return 90; })), Reason::kLowContrast);
  expect_reason(process(painted([](int x, int y) { return 20 + x / 16 + y / 16; })),
                Reason::kLowContrast);
  std::mt19937 random(1);
  std::normal_distribution<double> noise(110, 4);
  expect_reason(process(painted([&](int, int) { return noise(random); })), Reason::kLowContrast);
}

TEST(Reasons, NoCircleAmongStraightEdges) {
  expect_reason(process(painted([](int x, int y) { return x / 90 % 2 + y / 70 % 2 ? 180 : 40; })),
                Reason::kNoCircle);
}

TEST(Reasons, NoLineBesideTheRing) {
  const Target ring =
      host::near_miss_target(host::NearMissKind::kNoLine, host::default_target(), 0);
  expect_reason(process(host::render_frame(host::clean_scene(pose_at(500, 20, 20)),
                                           host::default_camera(), ring)),
                Reason::kNoLine);
}

TEST(Reasons, LayoutMismatchWithoutDots) {
  const Target bare =
      host::near_miss_target(host::NearMissKind::kNoDots, host::default_target(), 0);
  expect_reason(process(host::render_frame(host::clean_scene(pose_at(500, 20, 20)),
                                           host::default_camera(), bare)),
                Reason::kLayoutMismatch);
}

TEST(Reasons, PoolFullOfEdges) {
  std::mt19937 random(4);
  std::vector<double> cells(256 * 256);
  for (double& c : cells) c = static_cast<double>(random() % 256);
  const FrameResult result = process(painted(
      [&](int x, int y) { return cells[static_cast<std::size_t>((y / 4) * 256 + x / 4)]; }));
  EXPECT_NE(result.tally.pools_full, 0);
  expect_reason(result, Reason::kPoolFull);
}

TEST(Reasons, EveryReasonHasAName) {
  for (int r = 1; r < static_cast<int>(Reason::kCount); ++r) {
    EXPECT_STRNE(reason_name(static_cast<Reason>(r)), "") << r;
  }
}

}  // namespace
}  // namespace berth::test
