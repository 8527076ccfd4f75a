// Dots on clean frames against the projection of their centres.
#include <gtest/gtest.h>

#include "host_sim/io/camera_model.hpp"
#include "marker/locate_dots.hpp"
#include "target_scene.hpp"

namespace berth {
namespace {

MarkerSet locate(const TargetScene& scene, const RigidTransform& pose) {
  const TargetView view{scene.parameters.camera, scene.view(), pose};
  const ReferenceValues r = measure_reference(view, scene.parameters.target);
  MarkerSet markers;
  Work work;
  locate_dots(view, scene.parameters.target, r, 512, markers, work);
  return markers;
}

TEST(LocateDots, CentroidsLieAtTheProjectedCentresButForPerspective) {
  for (const double distance : {320.0, 700.0, 1500.0}) {
    for (const double tilt : {0.0, 15.0, 30.0}) {
      const TargetScene scene(distance, tilt, 130);
      const MarkerSet markers = locate(scene, scene.truth());
      for (int i = 0; i < 5; ++i) {
        ASSERT_TRUE(markers.markers[i].located) << distance << " " << tilt << " D" << i;
        const auto& c = scene.target.dots[static_cast<std::size_t>(i)].center;
        const Eigen::Vector2d p = host::project(
            scene.camera, scene.pose.R * Eigen::Vector3d(c[0], c[1], c[2]) + scene.pose.t);
        // The perspective bias reaches 0.3 px at 300 mm and 40 degrees.
        EXPECT_NEAR(markers.markers[i].center_px[0].raw() / 65536.0, p.x(), 0.3);
        EXPECT_NEAR(markers.markers[i].center_px[1].raw() / 65536.0, p.y(), 0.3);
      }
    }
  }
}

TEST(LocateDots, APredictionHalfARadiusOffDoesNotMoveThem) {
  const TargetScene scene(600, 20, 75);
  RigidTransform shifted = scene.truth();
  shifted.translation_mm[0] += q<18>(2.5);
  shifted.translation_mm[1] -= q<18>(2.0);
  const MarkerSet exact = locate(scene, scene.truth()), off = locate(scene, shifted);
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(off.markers[i].located);
    for (int k = 0; k < 2; ++k) {
      EXPECT_NEAR(off.markers[i].center_px[k].raw(), exact.markers[i].center_px[k].raw(), 1500);
    }
  }
}

TEST(LocateDots, AHiddenDotIsNotLocated) {
  TargetScene scene(600, 10, 0);
  host::Scene s = host::clean_scene(scene.pose);
  host::Occluder cover;
  cover.marker = "D2";
  cover.z_mm = -5;
  cover.outline_mm = {{35, -55}, {55, -55}, {55, -35}, {35, -35}};
  cover.level_dn = 90;
  s.occluders.push_back(cover);
  scene.frame = host::render_frame(s, scene.camera, scene.target);
  const MarkerSet markers = locate(scene, scene.truth());
  for (int i = 0; i < 5; ++i) EXPECT_EQ(markers.markers[i].located, i != 2) << i;
}

}  // namespace
}  // namespace berth
