// The fixed-point refinement against its double-precision twin.
#include <gtest/gtest.h>

#include "accuracy/clean_campaign.hpp"
#include "accuracy/outline_twin.hpp"

namespace berth::accuracy {
namespace {

TEST(OutlineTwin, FixedPointStaysWithinTwoFifthsOfTheBoundAtThreeHundredMillimetres) {
  const Rig rig = make_rig(true);
  for (int i = 0; i < 4; ++i) {
    host::SceneOptions options;
    options.seed = 61;
    options.clean = true;
    options.distance_mm = 300;
    options.tilt_deg = 2 + 8 * i;
    const host::Scene scene = host::sample_scene(options, static_cast<std::uint64_t>(i),
                                                 rig.host_camera, rig.host_target);
    const host::Image8 image = host::render_frame(scene, rig.host_camera, rig.host_target);
    const Trial fixed = refine_rendered(rig, scene, image, 0.3, 3);
    ASSERT_TRUE(fixed.ok);
    const TwinResult twin =
        refine_twin({rig.host_camera, rig.host_target, image, scene.pose, 30, 200});
    const Vector6 apart = pose_error(fixed.result.pose, twin.pose);
    const Matrix6 bound = bound_from_outlines(scene, rig.host_camera, rig.host_target);
    const double rotation = apart.head<3>().norm() * 180 / 3.14159265358979323846;
    // Slopes of the light and blur come from a quarter of the scan lines: up to 0.28 of the bound.
    EXPECT_LT(rotation, 0.4 * rotation_sigma_deg(bound)) << i;
    EXPECT_LT(apart.tail<3>().norm(), 0.4 * translation_sigma_mm(bound)) << i;
  }
}

}  // namespace
}  // namespace berth::accuracy
