// Every reason is provoked by an image. Not here: `deadline` (test_deadline.cpp), and
// `no_solution`, which P3P gives only where no triple has a pose in front of the camera.
#include <gtest/gtest.h>

#include <random>

#include "chain_tools.hpp"
#include "host_sim/campaign/near_miss.hpp"
#include "host_sim/render/sample_hazards.hpp"

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

/// Dots first .. last behind something as dark as the plate.
host::Scene hide_dots(const Target& target, std::size_t first, std::size_t last) {
  host::Scene scene = host::clean_scene(pose_at(500, 20, 20));
  for (std::size_t i = first; i <= last; ++i) {
    host::Occluder hidden = host::occlude_dot(target.dots[i], 0.3);
    hidden.level_dn = scene.light.black_dn;
    scene.occluders.push_back(hidden);
  }
  return scene;
}

/// CT-1F: no raised dot.
Target flat() {
  Target target = host::default_target();
  target.dots.erase(target.dots.begin());
  return target;
}

/// Far, dim, noisy.
host::Scene poor_scene(double tilt_deg, double motion_px) {
  host::Scene scene = host::clean_scene(pose_at(1480, tilt_deg, 20));
  scene.light.white_dn = 65;
  scene.noise_dn = 6;
  scene.optics.defocus_px = 2;
  scene.optics.motion_px = motion_px;
  return scene;
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

TEST(Reasons, DotMissingWithTwoOrThreeOfFiveLeft) {
  expect_reason(look(hide_dots(host::default_target(), 2, 4)), Reason::kDotMissing);
  expect_reason(look(hide_dots(host::default_target(), 1, 2)), Reason::kDotMissing);
  expect_reason(look(hide_dots(host::default_target(), 2, 2)), Reason::kNone);
}

TEST(Reasons, SaturatedWhereWhiteSpreads) {
  host::Scene scene = host::clean_scene(pose_at(1200, 20, 20));
  scene.light.white_dn = 800;
  scene.optics.defocus_px = 2;
  expect_reason(look(scene), Reason::kSaturated);
}

TEST(Reasons, SaturatedWhereMostOfTheImageIsWhite) {
  expect_reason(process(painted([](int, int) { return 255; })), Reason::kSaturated);
  expect_reason(process(painted([](int x, int y) { return x + y < 800 ? 90 : 255; })),
                Reason::kSaturated);
}

TEST(Reasons, ResidualTooLargeWithGlintsAtTheFourFlatDots) {
  host::Scene scene = host::clean_scene(pose_at(500, 20, 20));
  const Target target = host::default_target();
  const double aside[4][2] = {{0, 6}, {-6, 0}, {0, -6}, {6, 0}};
  for (std::size_t i = 0; i < 4; ++i) {
    const auto& c = target.dots[i + 1].center;
    scene.glints.push_back({c[0] + aside[i][0], c[1] + aside[i][1], 5, 300});
  }
  const FrameResult result = look(scene);
  expect_reason(result, Reason::kResidualTooLarge);
  EXPECT_TRUE(result.has_pose);
}

// Which of the two it is depends on the noise; a pose is never called valid here.
TEST(Reasons, AmbiguousOrImpreciseFlatTargetFarAway) {
  int ambiguous = 0, imprecise = 0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    host::Scene scene = poor_scene(5, 6);
    scene.noise_seed = seed;
    const FrameResult result = look(scene, flat());
    EXPECT_FALSE(result.valid) << seed;
    if (result.reason == Reason::kImprecise) ++imprecise;
    if (result.reason != Reason::kAmbiguous) continue;
    ++ambiguous;
    EXPECT_TRUE(result.has_pose);
    EXPECT_TRUE(result.pose.has_second);
  }
  EXPECT_GE(ambiguous, 1);
  EXPECT_GE(imprecise, 1);
}

// Three dots on a straight line are left.
TEST(Reasons, DegenerateWhereTheOnlyOtherDotIsHidden) {
  Target target = host::default_target();
  target.dots = {target.dots[1], target.dots[2], target.dots[1], target.dots[4]};
  target.dots[2].center = {0, -45, 0};
  target.dots[2].name = "D3";
  expect_reason(look(hide_dots(target, 3, 3), target), Reason::kDegenerate);
}

TEST(Reasons, PoolFullOfEdges) {
  std::mt19937 random(4);
  std::vector<double> cells(256 * 256);
  for (double& c : cells) c = static_cast<double>(random() % 256);
  Parameters parameters =
      host::make_parameters(host::default_camera(), host::default_target()).value();
  parameters.thresholds.search_budget_units = kMaxBudget_units;
  parameters.thresholds.frame_budget_units = kMaxBudget_units;
  const FrameResult result = process(
      painted([&](int x, int y) { return cells[static_cast<std::size_t>((y / 4) * 256 + x / 4)]; }),
      parameters);
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
