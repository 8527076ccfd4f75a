// Frames of the campaigns on which one step of the chain had gone wrong: what they have in common
// is the hazard, and their truth is the renderer's.
#include <gtest/gtest.h>

#include "chain_tools.hpp"
#include "host_sim/campaign/frame_maker.hpp"

namespace berth::test {
namespace {

using host::CampaignSet;

struct Place {
  CampaignSet set;
  std::uint64_t index, seed = 5;
};

// As precise as its distance asks, from at least so many markers.
void expect_precise(const Place& place, int markers = 4) {
  SCOPED_TRACE(std::to_string(place.index));
  const host::FrameMaker maker(place.set, place.seed, host::default_camera(),
                               host::default_target(), {});
  const host::CampaignFrame frame = maker.make(place.index);
  const FrameResult result = process(frame.image);
  ASSERT_TRUE(result.valid) << reason_name(result.reason);
  EXPECT_GE(result.pose.markers_used, markers);
  const PoseErrors e = errors_of(result.pose.camera_from_target, frame.scene.pose);
  const double scale = std::pow(frame.scene.pose.t.norm() / 300, 2);
  EXPECT_LE(e.rotation_deg, 0.015 * scale);
  EXPECT_LE(e.translation_mm, 0.2 * scale);
}

// Strong contrast, sharp but for motion: what is still too small of the blur there would refuse
// the dots.
TEST(Frames, BlurIsFollowedToTheEndBeforeDotsAreRefused) {
  expect_precise({CampaignSet::kEnvelope, 1266});
  expect_precise({CampaignSet::kEnvelope, 1862});
}

// Motion of 5 px: a first step that makes the blur across it far too small is slow to be undone.
TEST(Frames, BlurAcrossTheMotionDoesNotCollapse) {
  expect_precise({CampaignSet::kEnvelope, 1, 1}, 7);
}

// Line and dots in the sun, the rest in the shadow: two and a half times as bright.
TEST(Frames, MarkersInALightOfTheirOwnAreUsed) {
  expect_precise({CampaignSet::kSteep, 1149});
  expect_precise({CampaignSet::kSteep, 2231});
  expect_precise({CampaignSet::kSteep, 2478});
}

// Of these the line is beyond the scale, and wider for it, while the ring is not.
TEST(Frames, WhatIsClippedIsNotMeasured) { expect_precise({CampaignSet::kEnvelope, 14307, 0}); }

// Light from the side, a shadow, white beyond the scale: rounds that begin without knowing it.
TEST(Frames, LightThatTheFirstRoundsDoNotKnowRefusesNothing) {
  for (const std::uint64_t index : {135, 1235, 1693, 1829, 2209}) {
    expect_precise({CampaignSet::kSteep, index});
  }
  expect_precise({CampaignSet::kEnvelope, 2353});
}

// Nine by four cells in the coarse look, among clutter: its outline wavers, and its ends are as
// sharp as corners.
TEST(Frames, SteepRingsOfAFewCellsAreWhole) {
  expect_precise({CampaignSet::kSteep, 261});
  expect_precise({CampaignSet::kSteep, 2421});
}

}  // namespace
}  // namespace berth::test
