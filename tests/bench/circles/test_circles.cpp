// What bench_circles calls the ring, and its randomized Hough transform on a drawing.
#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "bench/circles/conditions.hpp"
#include "bench/circles/detectors.hpp"
#include "bench/circles/randomized_hough.hpp"
#include "host_sim/io/camera_file.hpp"
#include "host_sim/render/render.hpp"

namespace berth::bench {
namespace {

TEST(FoundCircle, ToleranceIsFivePercentOfTheLargerAxis) {
  const std::vector<FoundCircle> truth = {{{500, 400}, 100, 60, false}};
  EXPECT_TRUE(is_one_of({{504, 402}, 104, 62, false}, truth));
  EXPECT_FALSE(is_one_of({{504, 404}, 104, 62, false}, truth));
  EXPECT_FALSE(is_one_of({{500, 400}, 106, 60, false}, truth));
  EXPECT_FALSE(is_one_of({{500, 400}, 100, 64, false}, truth));
}

TEST(FoundCircle, ACircleNeedsARadiusBetweenTheAxes) {
  const std::vector<FoundCircle> truth = {{{500, 400}, 100, 60, false}};
  EXPECT_TRUE(is_one_of({{500, 400}, 80, 80, true}, truth));
  EXPECT_TRUE(is_one_of({{500, 400}, 57, 57, true}, truth));
  EXPECT_FALSE(is_one_of({{500, 400}, 50, 50, true}, truth));
  EXPECT_FALSE(is_one_of({{500, 400}, 106, 106, true}, truth));
}

TEST(TrueCircles, AFacingRingHasItsRadiusInPixels) {
  host::Scene scene = host::clean_scene({});
  scene.pose.t = {0, 0, 500};
  const auto camera = host::default_camera();
  const TrueCircles truth = true_circles(scene, camera, host::default_target());
  EXPECT_NEAR(truth.ring[0].major, camera.fx * 30 / 500, 0.2);
  EXPECT_NEAR(truth.ring[1].minor, camera.fx * 24 / 500, 0.2);
  EXPECT_NEAR(cv::norm(truth.ring[0].center - cv::Point2d(camera.cx, camera.cy)), 0, 0.1);
  EXPECT_EQ(truth.dots.size(), 5u);
}

TEST(RandomizedHough, FindsTheCirclesOfADrawing) {
  cv::Mat edges = cv::Mat::zeros(400, 400, CV_8U);
  cv::circle(edges, {120, 150}, 60, cv::Scalar(255));
  cv::circle(edges, {280, 240}, 90, cv::Scalar(255));
  cv::line(edges, {0, 390}, {399, 20}, cv::Scalar(255));
  const auto circles = randomized_hough(edges, {}, 5);
  const auto has = [&](double x, double y, double r) {
    return std::any_of(circles.begin(), circles.end(),
                       [&](const cv::Vec3d& c) { return cv::norm(c - cv::Vec3d(x, y, r)) < 3; });
  };
  EXPECT_TRUE(has(120, 150, 60));
  EXPECT_TRUE(has(280, 240, 90));
  EXPECT_EQ(circles.size(), 2u);
}

TEST(Conditions, EachShowsWhatItSays) {
  const auto camera = host::default_camera();
  const auto target = host::default_target();
  const auto all = all_conditions();
  EXPECT_EQ(make_scene(all[7], 3, camera, target).hidden_marker(), "ring");
  for (std::uint64_t i = 0; i < 20; ++i) {
    const double tilt = make_scene(all[4], i, camera, target).viewpoint.tilt_deg;
    EXPECT_GE(tilt, 45);
    EXPECT_LE(tilt, 60);
    EXPECT_GE(make_scene(all[8], i, camera, target).optics.motion_px, 4);
    EXPECT_GE(make_scene(all[10], i, camera, target).occluders.size(), 10u);
  }
}

TEST(CircleDetectors, AllFindACleanFacingRing) {
  host::SceneOptions options;
  options.clean = true;
  options.tilt_deg = 0;
  options.distance_mm = 500;
  const auto camera = host::default_camera();
  const auto target = host::default_target();
  const host::Scene scene = sample_scene(options, 0, camera, target);
  host::Image8 image = render_frame(scene, camera, target);
  const cv::Mat frame(image.height, image.width, CV_8U, image.data.data());
  const TrueCircles truth = true_circles(scene, camera, target);
  for (const CircleDetector& detector : all_circle_detectors()) {
    bool is_found = false;
    for (const auto& c : detector.detect(frame).circles) is_found |= is_one_of(c, truth.ring);
    EXPECT_TRUE(is_found) << detector.name;
  }
}

}  // namespace
}  // namespace berth::bench
