// Sizes: what blur, motion, gamma and shadows do to a target is no other proportion.
//
// Expected values are the drawn target's: the line is as wide as the ring, or a tenth off.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "host_sim/campaign/near_miss.hpp"
#include "target/verify_sizes.hpp"
#include "target_scene.hpp"

namespace berth {
namespace {

constexpr double kRad = TargetScene::CV_PI_180;

struct Look {
  double distance_mm = 1000, tilt_deg = 20, motion_px = 0, motion_deg = 0, defocus_px = 1;
  double gamma = 1, noise_dn = 1;
  host::PsfKind psf = host::PsfKind::kGaussian;
};

host::Scene scene_of(const TargetScene& place, const Look& look) {
  host::Scene scene = host::clean_scene(place.pose);
  scene.optics.motion_px = look.motion_px;
  scene.optics.motion_angle_rad = kRad * look.motion_deg;
  scene.optics.defocus_px = look.defocus_px;
  scene.optics.gamma = look.gamma;
  scene.optics.psf = look.psf;
  scene.noise_dn = look.noise_dn;
  return scene;
}

Sizes sizes_of(TargetScene& place, const host::Scene& scene, const host::Target& drawn) {
  place.frame = host::render_frame(scene, place.camera, drawn);
  const ImageView image = place.view();
  const Camera& camera = place.parameters.camera;
  const TargetView view{camera, image, place.truth()};
  const ReferenceValues reference = measure_reference(view, place.parameters.target);
  const auto noise_q8 = static_cast<std::uint16_t>(std::lround(256 * scene.noise_dn));
  return measure_sizes(view, place.parameters.target, reference, noise_q8);
}

host::Target with_line_width(double change) {
  return host::near_miss_target(host::NearMissKind::kLineWidth, host::default_target(), change);
}

template <typename Act>
void for_all_looks(Act act) {
  constexpr host::PsfKind kPsfs[3] = {host::PsfKind::kGaussian, host::PsfKind::kDisc,
                                      host::PsfKind::kBox};
  int index = 0;
  for (const double distance_mm : {400.0, 1000.0, 1450.0}) {
    for (const double gamma : {0.45, 1.0, 2.2}) {
      for (const double motion_deg : {0.0, 45.0, 90.0, 135.0}) {
        Look look;
        look.distance_mm = distance_mm;
        look.gamma = gamma;
        look.motion_px = 5;
        look.motion_deg = motion_deg;
        look.psf = kPsfs[index++ % 3];
        SCOPED_TRACE(std::to_string(distance_mm) + " mm, gamma " + std::to_string(gamma) +
                     ", motion at " + std::to_string(motion_deg));
        act(look);
      }
    }
  }
}

TEST(VerifySizes, MotionAndGammaAreNoOtherWidth) {
  for_all_looks([](const Look& look) {
    TargetScene place(look.distance_mm, look.tilt_deg, 30);
    const Sizes s = sizes_of(place, scene_of(place, look), host::default_target());
    ASSERT_TRUE(s.line_to_ring.is_known);
    EXPECT_LT(std::abs(s.line_to_ring.off), s.line_to_ring.tolerance * 3 / 4);
    EXPECT_TRUE(are_sizes_consistent(s));
  });
}

// A tenth is left to the outlines (test_sizes.cpp), which take up to a pixel more for their own.
TEST(VerifySizes, ASixthOfTheLinesWidthShowsUnderAnyMotionAndGamma) {
  for_all_looks([](const Look& look) {
    for (const double change : {-0.16, 0.16}) {
      TargetScene place(look.distance_mm, look.tilt_deg, 30);
      const Sizes s = sizes_of(place, scene_of(place, look), with_line_width(change));
      EXPECT_FALSE(are_sizes_consistent(s)) << change;
      EXPECT_EQ(s.line_to_ring.off > 0, change > 0);
    }
  });
}

TEST(VerifySizes, AShadowsEdgeAlongTheLineRefutesNothing) {
  for (const double offset_mm : {43.0, 44.0, 45.0, 46.0, 47.0}) {
    for (const double gamma : {0.45, 1.0, 2.2}) {
      TargetScene place(900, 15, 30);
      Look look;
      look.gamma = gamma;
      host::Scene scene = scene_of(place, look);
      scene.light.shadow = host::Shadow{0, 1, offset_mm, 1, 0.4};
      EXPECT_TRUE(are_sizes_consistent(sizes_of(place, scene, host::default_target())))
          << offset_mm << " mm, gamma " << gamma;
    }
  }
}

TEST(VerifySizes, ALineLostInAShadowIsNotShort) {
  TargetScene place(450, 30, 30);
  Look look;
  look.noise_dn = 5.5;
  host::Scene scene = scene_of(place, look);
  scene.light.white_dn = 34;
  scene.light.black_dn = 3;
  scene.light.shadow = host::Shadow{0, 1, 36, 1, 0.34};
  EXPECT_TRUE(are_sizes_consistent(sizes_of(place, scene, host::default_target())));
}

TEST(VerifySizes, BothLineEndsOffAreAnotherLength) {
  for (const double change : {-0.1, 0.1}) {
    for (const double distance_mm : {400.0, 1000.0, 1450.0}) {
      Look look;
      look.distance_mm = distance_mm;
      TargetScene place(distance_mm, look.tilt_deg, 30);
      const host::Target drawn =
          host::near_miss_target(host::NearMissKind::kLineLength, host::default_target(), change);
      const Sizes s = sizes_of(place, scene_of(place, look), drawn);
      const double expected_mm = 28 * change;
      EXPECT_NEAR(std::ldexp(s.line_end.shift_mm.raw(), -18), expected_mm, 0.6);
      EXPECT_FALSE(are_sizes_consistent(s));
    }
  }
}

}  // namespace
}  // namespace berth
