// The Cramer-Rao bound against independently computed values (zero distortion, t = Z (0.02, -0.03,
// 1), R = Rz(25 deg) Rx(tilt), white 200, black 30, blur 0.7 px, noise variance 4 + 1/12).
#include <gtest/gtest.h>

#include "accuracy/bound.hpp"
#include "host_sim/io/camera_file.hpp"
#include "host_sim/io/target_file.hpp"
#include "host_sim/render/sample_hazards.hpp"

namespace berth::accuracy {
namespace {

struct Row {
  double distance_mm, tilt_deg, rotation_deg, translation_mm;
};
constexpr Row kTable[] = {{300, 0, 0.00141, 0.00083}, {300, 40, 0.00076, 0.00130},
                          {500, 0, 0.0037, 0.0029},   {500, 40, 0.0017, 0.0050},
                          {800, 0, 0.0084, 0.0094},   {800, 40, 0.0035, 0.0166},
                          {1100, 0, 0.0141, 0.0210},  {1100, 40, 0.0056, 0.0375},
                          {1500, 0, 0.0233, 0.0459},  {1500, 40, 0.0090, 0.0829}};

host::Camera undistorted() {
  host::Camera camera = host::default_camera();
  camera.k1 = camera.k2 = camera.p1 = camera.p2 = camera.k3 = 0;
  return camera;
}

host::Scene scene_of(const Row& row) {
  constexpr double kRad = 3.14159265358979323846 / 180;
  host::Pose pose;
  pose.t = row.distance_mm * Eigen::Vector3d(0.02, -0.03, 1);
  pose.R = rotation_of(Eigen::Vector3d(0, 0, 25 * kRad)) *
           rotation_of(Eigen::Vector3d(row.tilt_deg * kRad, 0, 0));
  return host::clean_scene(pose);
}

class Bound : public testing::TestWithParam<Row> {};

TEST_P(Bound, FromRenderingsIsThePublishedValueWithinTenPercent) {
  const Row row = GetParam();
  const Matrix6 c = bound_from_renderings(scene_of(row), undistorted(), host::default_target());
  EXPECT_NEAR(rotation_sigma_deg(c) / row.rotation_deg, 1.0, 0.1);
  EXPECT_NEAR(translation_sigma_mm(c) / row.translation_mm, 1.0, 0.1);
}

TEST_P(Bound, AlongOutlinesAgreesWithTheRenderingsWithinTenPercent) {
  const host::Scene scene = scene_of(GetParam());
  const Matrix6 full = bound_from_renderings(scene, undistorted(), host::default_target());
  const Matrix6 fast = bound_from_outlines(scene, undistorted(), host::default_target());
  EXPECT_NEAR(rotation_sigma_deg(fast) / rotation_sigma_deg(full), 1.0, 0.1);
  EXPECT_NEAR(translation_sigma_mm(fast) / translation_sigma_mm(full), 1.0, 0.1);
}

// Root of the ratio of the bounds, rotation and translation.
void expect_agreement(const host::Scene& scene) {
  const Matrix6 full = bound_from_renderings(scene, undistorted(), host::default_target());
  const Matrix6 fast = bound_from_outlines(scene, undistorted(), host::default_target());
  EXPECT_NEAR(rotation_sigma_deg(fast) / rotation_sigma_deg(full), 1.0, 0.1);
  EXPECT_NEAR(translation_sigma_mm(fast) / translation_sigma_mm(full), 1.0, 0.1);
}

TEST(BoundOfDegradedFrames, MotionGradientAndShadowAreInTheFastForm) {
  host::Scene scene = scene_of({600, 20, 0, 0});
  scene.optics.motion_px = 4;
  scene.optics.motion_angle_rad = 0.6;
  expect_agreement(scene);
  scene.light.gradient_ratio = 3;
  scene.light.gradient_angle_rad = 1;
  expect_agreement(scene);
  scene.light.shadow = host::Shadow{1, 0, 5, 0, 0.5};
  expect_agreement(scene);
}

TEST(BoundOfDegradedFrames, SaturationIsInTheFastForm) {
  host::Scene scene = scene_of({600, 20, 0, 0});
  scene.light.white_dn = 300;
  expect_agreement(scene);
}

TEST(BoundOfDegradedFrames, OccludersAreInTheFastForm) {
  const host::Target target = host::default_target();
  for (const host::Occluder& occluder :
       {host::occlude_dot(target.dots[0], 0.3), host::occlude_dot(target.dots[2], 0.3),
        host::occlude_ring(target.ring, 1), host::occlude_line(target.line, 1)}) {
    host::Scene scene = scene_of({600, 20, 0, 0});
    scene.occluders.push_back(occluder);
    expect_agreement(scene);
  }
}

INSTANTIATE_TEST_SUITE_P(Table, Bound, testing::ValuesIn(kTable));

}  // namespace
}  // namespace berth::accuracy
