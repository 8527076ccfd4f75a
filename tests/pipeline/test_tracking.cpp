// A search that begins where the target was: the window, and what comes of a right or wrong prior.
#include <gtest/gtest.h>

#include "app/vision_task.hpp"
#include "chain_tools.hpp"
#include "host_sim/decode/decode.hpp"
#include "pipeline/window.hpp"

namespace berth::test {
namespace {

FrameResult process_from(const Prior& prior, const host::Image8& image) {
  return process(
      image, host::make_parameters(host::default_camera(), host::default_target()).value(), prior);
}

host::Image8 clean_frame(const host::Pose& pose) {
  return render_frame(host::clean_scene(pose), host::default_camera(), host::default_target());
}

// Pinhole projection with HEC-1's distortion, in double precision.
Eigen::Vector2d project_in_double(const host::Camera& c, const Eigen::Vector3d& p) {
  const double x = p.x() / p.z(), y = p.y() / p.z(), r2 = x * x + y * y;
  const double radial = 1 + r2 * (c.k1 + r2 * (c.k2 + r2 * c.k3));
  return {c.fx * (x * radial + 2 * c.p1 * x * y + c.p2 * (r2 + 2 * x * x)) + c.cx,
          c.fy * (y * radial + c.p1 * (r2 + 2 * y * y) + 2 * c.p2 * x * y) + c.cy};
}

TEST(Window, holds_the_plate_with_room_around_it_and_stays_in_the_frame) {
  const host::Camera camera = host::default_camera();
  const Parameters parameters = host::make_parameters(camera, host::default_target()).value();
  for (const double distance : {300., 700., 1500.}) {
    for (int i = 0; i < 24; ++i) {
      host::Pose pose = pose_at(distance, 2.5 * i, 15. * i);
      pose.t.head<2>() += Eigen::Vector2d(0.25 * std::cos(i), 0.25 * std::sin(i)) * distance;
      const SearchGrid grid =
          window_around(parameters.camera, parameters.target, prior_of(pose).camera_from_target);
      const int right = grid.x0 + 2 * grid.width, bottom = grid.y0 + 2 * grid.height;
      EXPECT_GE(grid.x0, 0);
      EXPECT_GE(grid.y0, 0);
      EXPECT_LE(right, camera.width);
      EXPECT_LE(bottom, camera.height);
      EXPECT_GE(grid.width, 12);
      for (const double x : {-60., 60.}) {
        for (const double y : {-60., 60.}) {
          const Eigen::Vector2d corner =
              project_in_double(camera, pose.R * Eigen::Vector3d(x, y, 0) + pose.t);
          EXPECT_LE(grid.x0, std::max(0., corner.x() - 16));
          EXPECT_LE(grid.y0, std::max(0., corner.y() - 16));
          EXPECT_GE(right, std::min(camera.width - 2., corner.x() + 14));
          EXPECT_GE(bottom, std::min(camera.height - 2., corner.y() + 14));
        }
      }
    }
  }
}

TEST(Window, of_a_target_outside_the_frame_is_no_larger_than_the_frame) {
  const Parameters parameters =
      host::make_parameters(host::default_camera(), host::default_target()).value();
  for (const double side : {-1., 1.}) {
    host::Pose pose = pose_at(500, 10, 0);
    pose.t.x() = 900 * side;
    const SearchGrid grid =
        window_around(parameters.camera, parameters.target, prior_of(pose).camera_from_target);
    EXPECT_GE(grid.x0, 0);
    EXPECT_LE(grid.x0 + 2 * grid.width, 1024);
    EXPECT_LE(grid.y0 + 2 * grid.height, 1024);
  }
}

TEST(Window, of_a_plate_that_reaches_behind_the_camera_is_the_whole_frame) {
  const Parameters parameters =
      host::make_parameters(host::default_camera(), host::default_target()).value();
  for (int turn = 0; turn < 360; turn += 45) {
    const SearchGrid grid = window_around(parameters.camera, parameters.target,
                                          prior_of(pose_at(30, 80, turn)).camera_from_target);
    EXPECT_EQ(grid.x0, 0);
    EXPECT_EQ(grid.y0, 0);
    EXPECT_EQ(2 * grid.width, 1024);
    EXPECT_EQ(2 * grid.height, 1024);
  }
}

TEST(Tracking, gives_the_pose_of_the_whole_frame_for_a_part_of_the_work) {
  for (const double distance : {300., 800., 1500.}) {
    const host::Pose pose = pose_at(distance, 20, 30);
    host::Pose before = pose;  // a frame ago: 20 mm/s and 2 deg/s
    before.t += Eigen::Vector3d(2.5, 1, -1);
    before.R = Eigen::AngleAxisd(0.005, Eigen::Vector3d::UnitY()).toRotationMatrix() * pose.R;
    const host::Image8 image = clean_frame(pose);
    const FrameResult whole = process(image), tracked = process_from(prior_of(before), image);
    ASSERT_TRUE(whole.valid);
    ASSERT_TRUE(tracked.valid);
    EXPECT_LT(tracked.work_units, whole.work_units);
    const RigidTransform &a = whole.pose.camera_from_target, &b = tracked.pose.camera_from_target;
    for (int k = 0; k < 3; ++k) {
      EXPECT_LT(std::abs((a.translation_mm[k] - b.translation_mm[k]).raw()),
                whole.pose.covariance.sigma_translation_mm[k].raw() / 10 + 4);
    }
  }
}

// Two millimetres and a quarter of a degree aside, in all light and blur of the envelope.
TEST(Tracking, near_the_last_pose_no_edges_are_needed_for_the_same_pose) {
  int found = 0;
  double sum = 0;
  for (std::uint64_t i = 0; i < 24; ++i) {
    host::SceneOptions options;
    options.seed = 5;
    const host::Scene scene =
        host::sample_scene(options, i, host::default_camera(), host::default_target());
    const host::Image8 image = render_frame(scene, host::default_camera(), host::default_target());
    const FrameResult whole = process(image);
    if (!whole.valid) continue;
    ++found;
    host::Pose before = scene.pose;
    const double angle = 2.4 * static_cast<double>(i);
    before.t += 2 * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
    before.R = Eigen::AngleAxisd(0.0044, Eigen::Vector3d::UnitY()).toRotationMatrix() * before.R;
    Prior prior = prior_of(before);
    prior.blur = whole.blur;
    const FrameResult tracked = process_from(prior, image);
    ASSERT_TRUE(tracked.valid) << i;
    EXPECT_EQ(tracked.tally.edge_pixels, 0) << i;
    EXPECT_LT(tracked.work_units, whole.work_units) << i;
    for (int k = 0; k < 3; ++k) {
      const double off = (tracked.pose.camera_from_target.translation_mm[k] -
                          whole.pose.camera_from_target.translation_mm[k])
                             .raw();
      const double sigmas = off / whole.pose.covariance.sigma_translation_mm[k].raw();
      EXPECT_LT(std::abs(sigmas), 3) << i;
      sum += sigmas * sigmas;
    }
  }
  EXPECT_GE(found, 20);
  EXPECT_LT(std::sqrt(sum / (3 * found)), 0.5);
}

// What the last frame's blur was makes a start, no more: far off it is not believed.
TEST(Tracking, a_blur_that_was_another_leaves_the_pose_as_it_is) {
  const host::Pose pose = pose_at(700, 15, 40);
  const host::Image8 image = clean_frame(pose);
  const FrameResult fresh = process_from(prior_of(pose), image);
  ASSERT_TRUE(fresh.valid);
  for (const double variance : {0.2, 0.9, 6.}) {
    for (const double turned : {-0.9, 0., 0.9}) {
      Prior prior = prior_of(pose);
      const auto px2 = [](double v) {
        return Q<16>::from_raw(static_cast<std::int32_t>(std::lround(std::ldexp(v, 16))));
      };
      prior.blur = {px2(variance), px2(turned * variance), px2(variance)};
      const FrameResult result = process_from(prior, image);
      ASSERT_TRUE(result.valid);
      for (int k = 0; k < 3; ++k) {
        const std::int32_t off = (result.pose.camera_from_target.translation_mm[k] -
                                  fresh.pose.camera_from_target.translation_mm[k])
                                     .raw();
        EXPECT_LT(std::abs(off), fresh.pose.covariance.sigma_translation_mm[k].raw() / 4 + 4)
            << variance << " " << turned;
      }
    }
  }
}

TEST(Tracking, a_target_that_has_jumped_is_found_in_the_same_frame) {
  host::Pose there = pose_at(900, 10, 0);
  there.t.x() = -250;
  host::Pose here = there;
  here.t.x() = 250;
  const host::Image8 image = clean_frame(here);
  const FrameResult result = process_from(prior_of(there), image);
  ASSERT_TRUE(result.valid);
  const RigidTransform& found = result.pose.camera_from_target;
  const RigidTransform& fresh = process(image).pose.camera_from_target;
  for (int k = 0; k < 9; ++k) EXPECT_EQ(found.rotation(k / 3, k % 3), fresh.rotation(k / 3, k % 3));
  for (int k = 0; k < 3; ++k) EXPECT_EQ(found.translation_mm[k], fresh.translation_mm[k]);
}

TEST(Tracking, a_prior_makes_no_target_where_there_is_none) {
  const auto plain = painted([](int x, int y) { return 100 + (x * 7 + y * 13) % 5; });
  const FrameResult result = process_from(prior_of(pose_at(600, 0, 0)), plain);
  EXPECT_FALSE(result.identified);
  EXPECT_FALSE(result.has_pose);
  EXPECT_NE(result.reason, Reason::kNone);
}

/// The result of each frame of a sequence, by the task that the firmware runs.
std::vector<FrameResult> results_of(const std::vector<const host::Image8*>& frames, bool track) {
  const Parameters parameters =
      host::make_parameters(host::default_camera(), host::default_target(), {}, {track}).value();
  const auto workspace = std::make_unique<Workspace>();
  FrameResult result;
  std::vector<std::uint8_t> buffer(kFrameLineBytes);
  LineWriter line(buffer);
  VisionTask task(parameters, {*workspace, result, line});
  std::vector<FrameResult> results;
  for (const host::Image8* image : frames) {
    hal::CameraFrame frame;
    if (image) {
      frame.status = hal::FrameStatus::kComplete;
      frame.pixels = image->data;
      frame.width = image->width;
      frame.height = image->height;
    }
    task.on_frame(frame);
    results.push_back(result);
  }
  return results;
}

void expect_same(const FrameResult& a, const FrameResult& b) {
  EXPECT_EQ(a.work_units, b.work_units);
  for (int s = 0; s < kStageCount; ++s) EXPECT_EQ(a.digests[s], b.digests[s]) << s;
}

TEST(Tracking, the_task_remembers_a_pose_in_its_mode_only_and_only_until_a_frame_without_one) {
  const host::Pose pose = pose_at(900, 10, 0);
  const host::Image8 image = clean_frame(pose);
  host::Scene moving = host::clean_scene(pose);
  moving.optics.motion_px = 1.5;
  const host::Image8 blurred = render_frame(moving, host::default_camera(), host::default_target());
  const host::Image8 plain = painted([](int, int) { return 90; });
  const auto fresh = results_of({&image}, false);
  const auto tracked = results_of({&image, &image, &plain, &image, nullptr, &image}, true);
  expect_same(tracked[0], fresh[0]);
  EXPECT_LT(tracked[1].work_units, fresh[0].work_units);
  expect_same(tracked[3], fresh[0]);
  expect_same(tracked[5], fresh[0]);
  const auto single = results_of({&blurred, &image, &image}, false);
  expect_same(single[1], fresh[0]);
  expect_same(single[2], fresh[0]);
}

}  // namespace
}  // namespace berth::test
