// Near misses differ from the target in one thing, by as much as they say.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "host_sim/campaign/near_miss.hpp"

namespace berth::host {
namespace {

TEST(NearMiss, EveryKindHasANameOfItsOwn) {
  std::set<std::string> names;
  for (int k = 0; k < kNearMissKinds; ++k) {
    names.insert(near_miss_name(static_cast<NearMissKind>(k)));
  }
  EXPECT_EQ(names.size(), static_cast<size_t>(kNearMissKinds));
}

TEST(NearMiss, OneDimensionIsOff) {
  const Target ct1 = default_target();
  Target t = near_miss_target(NearMissKind::kRingRadius, ct1, 0.1);
  EXPECT_DOUBLE_EQ(t.ring.outer, 33);
  EXPECT_DOUBLE_EQ(t.ring.inner, 27);
  t = near_miss_target(NearMissKind::kRingWidth, ct1, -0.1);
  EXPECT_DOUBLE_EQ(t.ring.outer, 30);
  EXPECT_DOUBLE_EQ(t.ring.inner, 24.6);
  t = near_miss_target(NearMissKind::kLineLength, ct1, 0.1);
  EXPECT_DOUBLE_EQ(t.line.length, 61.6);
  t = near_miss_target(NearMissKind::kLineDistance, ct1, 0.1);
  EXPECT_DOUBLE_EQ(t.line.center[1], 49.5);
  t = near_miss_target(NearMissKind::kDotDistance, ct1, -0.1);
  EXPECT_DOUBLE_EQ(t.dots[1].center[0], -40.5);
  EXPECT_DOUBLE_EQ(t.dots[0].center[2], -20);
  t = near_miss_target(NearMissKind::kLineTurned, ct1, 0.5);
  EXPECT_NEAR(std::hypot(t.line.center[0], t.line.center[1]), 45, 1e-9);
  EXPECT_NEAR(t.line.angle_deg, 0.5 * 180 / 3.14159265358979, 1e-9);
}

TEST(NearMiss, ShiftIsWhatTheDescriptionsDifferBy) {
  const Target ct1 = default_target();
  EXPECT_DOUBLE_EQ(near_miss_shift_mm(NearMissKind::kRingRadius, ct1, -0.1), 3);
  EXPECT_NEAR(near_miss_shift_mm(NearMissKind::kRingWidth, ct1, 0.1), 0.6, 1e-12);
  EXPECT_NEAR(near_miss_shift_mm(NearMissKind::kLineLength, ct1, 0.1), 2.8, 1e-12);
  const Target turned = near_miss_target(NearMissKind::kLineTurned, ct1, 0.5);
  EXPECT_NEAR(near_miss_shift_mm(NearMissKind::kLineTurned, ct1, 0.5),
              std::hypot(turned.line.center[0], turned.line.center[1] - 45), 1e-9);
}

TEST(NearMiss, ChangesAreAtLeastATenth) {
  Random random(7);
  for (int i = 0; i < 1000; ++i) {
    const double amount = draw_amount(NearMissKind::kDotDistance, random);
    EXPECT_GE(std::abs(amount), 0.10);
    EXPECT_LE(std::abs(amount), 0.18);
  }
}

TEST(NearMiss, PlainOnesHaveNeitherLineNorDots) {
  for (const auto kind : {NearMissKind::kRing, NearMissKind::kDisc, NearMissKind::kConcentric}) {
    const Target t = near_miss_target(kind, default_target(), 0);
    EXPECT_TRUE(t.dots.empty());
    EXPECT_EQ(t.line.length, 0);
  }
}

}  // namespace
}  // namespace berth::host
