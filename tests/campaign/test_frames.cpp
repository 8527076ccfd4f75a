// What stands in which set.
#include <gtest/gtest.h>

#include "host_sim/campaign/frame_maker.hpp"
#include "host_sim/render/sample_pose.hpp"
#include "host_sim/render/sample_scene.hpp"

namespace berth::host {
namespace {

FrameMaker maker_of(CampaignSet set, uint64_t seed = 3) {
  return FrameMaker(set, seed, default_camera(), default_target(), std::nullopt);
}

TEST(CampaignFrames, EnvelopeIsTheRenderersSequence) {
  SceneOptions options;
  options.seed = 3;
  const Scene scene = sample_scene(options, 5, default_camera(), default_target());
  const CampaignFrame frame = maker_of(CampaignSet::kEnvelope).make(5);
  EXPECT_EQ(frame.image.data, render_frame(scene, default_camera(), default_target()).data);
}

TEST(CampaignFrames, SteepShowsTheWholeLineFrom40To60Degrees) {
  double least = 90, most = 0;
  for (uint64_t index = 0; index < 200; ++index) {
    const Scene scene = steep_scene(3, index, default_camera(), default_target());
    least = std::min(least, scene.viewpoint.tilt_deg);
    most = std::max(most, scene.viewpoint.tilt_deg);
    EXPECT_TRUE(scene.is_plate_inside) << index;
    EXPECT_FALSE(is_line_covered(scene.pose, default_camera(), default_target())) << index;
    EXPECT_NE(scene.hidden_marker(), "line") << index;
  }
  EXPECT_GE(least, 40);
  EXPECT_LT(least, 41);
  EXPECT_LE(most, 60);
  EXPECT_GT(most, 59);
}

TEST(CampaignFrames, CollarCoversTheLineWhenSteepOnItsSide) {
  // Beyond 55 degrees at 300 mm the collar may cover a part of the line (the target's spec).
  Viewpoint view;
  view.distance_mm = 300;
  view.center_px = {512, 512};
  view.tilt_deg = 64;
  int covered = 0;
  for (view.tilt_direction_deg = 0; view.tilt_direction_deg < 360; view.tilt_direction_deg += 10) {
    covered += is_line_covered(pose_from_viewpoint(view, default_camera()), default_camera(),
                               default_target());
  }
  EXPECT_GT(covered, 0);
  EXPECT_LT(covered, 12);
  view.tilt_deg = 30;
  for (view.tilt_direction_deg = 0; view.tilt_direction_deg < 360; view.tilt_direction_deg += 10) {
    EXPECT_FALSE(is_line_covered(pose_from_viewpoint(view, default_camera()), default_camera(),
                                 default_target()));
  }
}

TEST(CampaignFrames, SomethingIsHiddenInEveryHiddenFrame) {
  const FrameMaker maker = maker_of(CampaignSet::kHidden);
  int dots = 0, rings = 0, lines = 0;
  SceneOptions options;
  options.share_occluded = 1.0;
  for (uint64_t index = 0; index < 300; ++index) {
    const Scene scene = sample_scene(options, index, default_camera(), default_target());
    ASSERT_EQ(scene.occluders.size(), 1u);
    const std::string hidden = scene.hidden_marker();
    (hidden == "ring" ? rings : hidden == "line" ? lines : dots) += 1;
  }
  EXPECT_NEAR(dots, 100, 25);
  EXPECT_NEAR(rings, 100, 25);
  EXPECT_NEAR(lines, 100, 25);
}

TEST(CampaignFrames, EmptyFramesHaveNoTruth) {
  const FrameMaker maker = maker_of(CampaignSet::kEmpty);
  for (uint64_t index = 0; index < 12; index += 2) {
    const CampaignFrame frame = maker.make(index);
    EXPECT_FALSE(frame.scene.has_target);
    EXPECT_NE(frame.kind, "photo");
    EXPECT_EQ(frame.image.data.size(), 1024u * 1024u);
  }
}

}  // namespace
}  // namespace berth::host
