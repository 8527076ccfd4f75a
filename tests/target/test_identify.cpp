// Roll search and line test on clean frames of known pose.
#include <gtest/gtest.h>

#include "fixed/trigonometry.hpp"
#include "target/identify.hpp"
#include "target/line_test.hpp"
#include "target/roll_search.hpp"
#include "target_scene.hpp"

namespace berth {
namespace {

// The true plate with its x axis turned away by `degrees`: what stage 3 knows before the roll.
RigidTransform turned(const TargetScene& scene, double degrees) {
  const RigidTransform t = scene.truth();
  PlatePose plate;
  plate.basis = t.rotation;
  plate.center_mm = t.translation_mm;
  const double a = degrees * TargetScene::CV_PI_180;
  return with_roll(plate, Unit::saturated(std::llround(std::cos(a) * (1 << 30))),
                   Unit::saturated(std::llround(std::sin(a) * (1 << 30))));
}

TEST(RollSearch, FindsTheRollToHalfAStep) {
  for (const double tilt : {0.0, 25.0, 40.0}) {
    const TargetScene scene(600, tilt, 35);
    for (const double away : {0.0, 33.0, 121.0, -152.0, 178.0}) {
      const TargetView view{scene.parameters.camera, scene.view(), turned(scene, away)};
      const ReferenceValues reference = measure_reference(view, scene.parameters.target);
      const RollScore roll = search_roll(view, scene.parameters.target, reference);
      const double found = roll.angle.raw() / double(1 << 28) / TargetScene::CV_PI_180;
      EXPECT_LT(std::abs(std::remainder(found + away, 360.0)), 2.6 + 1.0) << away;
    }
  }
}

TEST(Reference, LevelsAreThoseOfTheScene) {
  const TargetScene scene(500, 20, 10);
  const TargetView view{scene.parameters.camera, scene.view(), scene.truth()};
  const ReferenceValues r = measure_reference(view, scene.parameters.target);
  EXPECT_NEAR(r.white / 16.0, 200, 3);
  EXPECT_NEAR(r.black / 16.0, 30, 3);
  EXPECT_EQ(r.bright_sectors, kReferenceSectors);
  EXPECT_GE(r.hollow_sectors, kReferenceSectors - 6);  // D0 and its collar
}

TEST(LineTest, MeasuresAWrongRoll) {
  const TargetScene scene(450, 15, -60);
  for (const double away : {-2.0, -0.5, 0.0, 1.0, 2.5}) {
    const TargetView view{scene.parameters.camera, scene.view(), turned(scene, away)};
    const ReferenceValues r = measure_reference(view, scene.parameters.target);
    const LineTest line = test_line(view, scene.parameters.target, r, 512);
    ASSERT_TRUE(line.is_line) << away;
    EXPECT_EQ(line.stations, kLineStations);
    EXPECT_NEAR(line.turn.raw() / double(1 << 28) / TargetScene::CV_PI_180, -away, 0.3);
  }
}

TEST(LineTest, OtherThingsAreNoLine) {
  const TargetScene scene(450, 15, 0);
  for (const double away : {90.0, 180.0, 270.0, 45.0, 20.0}) {
    const TargetView view{scene.parameters.camera, scene.view(), turned(scene, away)};
    const ReferenceValues r = measure_reference(view, scene.parameters.target);
    const LineTest line = test_line(view, scene.parameters.target, r, 512);
    EXPECT_FALSE(line.is_line && line.stations >= 4) << away << ": " << line.stations;
  }
}

}  // namespace
}  // namespace berth
