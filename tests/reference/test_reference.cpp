// The OpenCV pipeline against the renderer's truth.
#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "scenes.hpp"

namespace berth::test {
namespace {

using namespace berth::host;

TEST(Reference, CleanFramesOverDistanceAndTilt) {
  const Camera camera = default_camera();
  const Target target = default_target();
  int beyond_three_sigma = 0;
  for (const double distance_mm : {300.0, 500.0, 800.0, 1100.0, 1500.0}) {
    for (const double tilt_deg : {0.0, 15.0, 30.0, 40.0}) {
      const Scene scene = clean_scene(pose_at(distance_mm, tilt_deg, 25));
      const ReferencePose pose = reference_pose(frame_of(scene, camera, target), camera, target);
      ASSERT_TRUE(pose.found) << distance_mm << " mm, " << tilt_deg << " deg: " << pose.why_not;
      const Errors e = errors_of(pose, scene.pose);
      EXPECT_TRUE(e.is_high_precision())
          << distance_mm << " mm, " << tilt_deg << " deg: " << e.rotation_deg << " deg, "
          << e.translation_mm << " mm";
      EXPECT_LT(e.largest_sigmas, 4.5);
      beyond_three_sigma += e.largest_sigmas > 3;
    }
  }
  EXPECT_LE(beyond_three_sigma, 1);
}

TEST(Reference, EnvelopeFramesAreFoundAndNeverFarOff) {
  constexpr std::uint64_t kFrames = 40;
  const Camera camera = default_camera();
  const Target target = default_target();
  SceneOptions options;
  options.seed = 11;
  int found = 0;
  for (std::uint64_t i = 0; i < kFrames; ++i) {
    const Scene scene = sample_scene(options, i, camera, target);
    const ReferencePose pose = reference_pose(frame_of(scene, camera, target), camera, target);
    if (!pose.found) continue;
    ++found;
    const Errors e = errors_of(pose, scene.pose);
    EXPECT_FALSE(e.is_false()) << "frame " << i << ": " << e.rotation_deg << " deg, "
                               << e.translation_mm << " mm";
  }
  EXPECT_GE(found, 36);
}

TEST(Reference, NothingIsFoundWhereThereIsNoTarget) {
  const Camera camera = default_camera();
  const Target target = default_target();
  SceneOptions options;
  options.seed = 12;
  options.with_target = false;
  for (std::uint64_t i = 0; i < 15; ++i) {
    const Scene scene = sample_scene(options, i, camera, target);
    const ReferencePose pose = reference_pose(frame_of(scene, camera, target), camera, target);
    EXPECT_FALSE(pose.found) << i;
    EXPECT_FALSE(pose.why_not.empty());
  }
}

TEST(Reference, BlackOnWhiteIsTheComplement) {
  const Camera camera = default_camera();
  Target target = default_target();
  const Scene scene = clean_scene(pose_at(600, 20, 100));
  const cv::Mat frame = frame_of(scene, camera, target);
  const ReferencePose white = reference_pose(frame, camera, target);
  target.white_on_black = false;
  const ReferencePose black = reference_pose(cv::Mat(255 - frame), camera, target);
  ASSERT_TRUE(white.found && black.found);
  EXPECT_EQ(white.camera_from_target.t, black.camera_from_target.t);
  EXPECT_FALSE(reference_pose(frame, camera, target).found);
}

TEST(Reference, OddInputHasAReason) {
  const Camera camera = default_camera();
  const Target target = default_target();
  EXPECT_EQ(reference_pose(cv::Mat(), camera, target).why_not,
            "the image is not 8-bit grey of the camera's size");
  for (const int level : {0, 128, 255}) {
    const cv::Mat plain(camera.height, camera.width, CV_8UC1, cv::Scalar(level));
    EXPECT_FALSE(reference_pose(plain, camera, target).found);
  }
  cv::Mat noise(camera.height, camera.width, CV_8UC1);
  cv::theRNG().state = 1;
  cv::randu(noise, 0, 256);
  EXPECT_FALSE(reference_pose(noise, camera, target).found);
}

}  // namespace
}  // namespace berth::test
