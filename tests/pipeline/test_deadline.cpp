// A budget that is spent ends the frame in time, with a reason, and never with a pose that is
// wrong.
#include <gtest/gtest.h>

#include "chain_tools.hpp"

namespace berth::test {
namespace {

// What was begun is ended: a row, a fit, a plate, the triples of a pose.
constexpr std::uint32_t kOverrun_units = 1500;

FrameResult look_within(const host::Image8& image, std::int32_t search_units,
                        std::int32_t frame_units) {
  Parameters parameters =
      host::make_parameters(host::default_camera(), host::default_target()).value();
  parameters.thresholds.search_budget_units = search_units;
  parameters.thresholds.frame_budget_units = frame_units;
  return process(image, parameters);
}

host::Image8 frame_of(std::uint64_t index) {
  const host::Camera camera = host::default_camera();
  const host::Target target = host::default_target();
  host::SceneOptions options;
  options.seed = 4;
  return host::render_frame(host::sample_scene(options, index, camera, target), camera, target);
}

bool is_same_pose(const FrameResult& a, const FrameResult& b) {
  const RigidTransform &p = a.pose.camera_from_target, &q = b.pose.camera_from_target;
  bool is_same = true;
  for (int i = 0; i < 9; ++i)
    is_same = is_same && p.rotation(i / 3, i % 3) == q.rotation(i / 3, i % 3);
  for (int i = 0; i < 3; ++i) is_same = is_same && p.translation_mm[i] == q.translation_mm[i];
  return is_same;
}

TEST(Deadline, NothingIsDoneOnABudgetOfZero) {
  const FrameResult result = look_within(frame_of(0), 0, 0);
  EXPECT_EQ(result.reason, Reason::kDeadline);
  EXPECT_FALSE(result.valid || result.identified || result.has_pose);
  EXPECT_EQ(result.work_units, 0u);
}

TEST(Deadline, AWrongSizeIsABadFrameWhateverTheBudget) {
  host::Image8 image = frame_of(0);
  image.height = 1023;
  EXPECT_EQ(look_within(image, 0, 0).reason, Reason::kBadFrame);
}

TEST(Deadline, ShortSearchesEndInTimeWithoutAPose) {
  for (std::uint64_t index = 0; index < 6; ++index) {
    const host::Image8 image = frame_of(index);
    const FrameResult full = look_within(image, kMaxBudget_units, kMaxBudget_units);
    for (int part = 1; part < 24; ++part) {
      const auto budget = static_cast<std::int32_t>(full.work_units) * part / 24;
      const FrameResult result = look_within(image, budget, kMaxBudget_units);
      EXPECT_LE(result.work_units, full.work_units);
      if (result.reason == Reason::kDeadline) {
        EXPECT_FALSE(result.valid || result.identified || result.has_pose);
        EXPECT_GE(result.work_units + kOverrun_units, static_cast<std::uint32_t>(budget));
        EXPECT_LE(result.work_units, static_cast<std::uint32_t>(budget) + kOverrun_units);
      } else {  // found in time: all is as without a budget
        EXPECT_EQ(result.reason, full.reason);
        EXPECT_EQ(result.valid, full.valid);
        EXPECT_TRUE(is_same_pose(result, full));
      }
    }
  }
}

TEST(Deadline, TheBestPoseSoFarIsReportedButNotAsValid) {
  const host::Pose truth = pose_at(600, 25, 40);
  const host::Image8 image =
      host::render_frame(host::clean_scene(truth), host::default_camera(), host::default_target());
  const FrameResult full = look_within(image, kMaxBudget_units, kMaxBudget_units);
  ASSERT_TRUE(full.valid);
  const FrameResult result =
      look_within(image, kMaxBudget_units, static_cast<std::int32_t>(full.work_units) - 1);
  EXPECT_EQ(result.reason, Reason::kDeadline);
  EXPECT_TRUE(result.identified);
  ASSERT_TRUE(result.has_pose);
  EXPECT_FALSE(result.valid);
  const PoseErrors errors = errors_of(result.pose.camera_from_target, truth);
  EXPECT_LT(errors.rotation_deg, 0.3);
  EXPECT_LT(errors.translation_mm, 1.5);
  const PoseCovariance& c = result.pose.covariance;
  EXPECT_GT(c.sigma_translation_mm[2].raw(), 0);
  EXPECT_LT(
      std::abs(result.pose.camera_from_target.translation_mm[2].raw() / 262144.0 - truth.t[2]),
      4 * c.sigma_translation_mm[2].raw() / 262144.0);
  EXPECT_LT(result.work_units, full.work_units);
}

TEST(Deadline, TheFramesBudgetBoundsTheSearchToo) {
  const FrameResult result = look_within(frame_of(1), kMaxBudget_units, 3000);
  EXPECT_EQ(result.reason, Reason::kDeadline);
  EXPECT_LE(result.work_units, 3000 + kOverrun_units);
}

TEST(Deadline, CostlyImagesEndInTime) {
  const auto within = [](const host::Image8& image, const char* what) {
    for (const std::int32_t budget : {2000, 12000, 20000}) {
      const FrameResult result = look_within(image, budget, kMaxBudget_units);
      EXPECT_FALSE(result.valid) << what;
      EXPECT_LE(result.work_units, static_cast<std::uint32_t>(budget) + kOverrun_units) << what;
    }
  };
  within(painted([](int x, int y) { return (x / 8 + y / 8) % 2 ? 220 : 30; }), "checkerboard");
  for (const int pitch : {24, 64, 128, 256}) {
    within(painted([&](int x, int y) {
             const double r = std::hypot(x % pitch - pitch / 2, y % pitch - pitch / 2);
             return r > 0.3 * pitch && r < 0.375 * pitch ? 200 : 30;
           }),
           "rings");
  }
}

}  // namespace
}  // namespace berth::test
