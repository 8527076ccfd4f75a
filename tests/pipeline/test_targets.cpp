// Targets are data: polarity and size come from the description; what is not the target is refused.
#include <gtest/gtest.h>

#include "chain_tools.hpp"

namespace berth::test {
namespace {

using host::Camera;
using host::Target;

host::Image8 clean_frame(const Target& target, const host::Pose& pose) {
  return host::render_frame(host::clean_scene(pose), host::default_camera(), target);
}

Target scaled(double scale) {
  Target target = host::default_target();
  for (double& side : target.plate_size_mm) side *= scale;
  target.ring.outer *= scale, target.ring.inner *= scale;
  for (double& c : target.line.center) c *= scale;
  target.line.length *= scale, target.line.width *= scale;
  for (host::Dot& dot : target.dots) {
    for (double& c : dot.center) c *= scale;
    dot.radius *= scale, dot.collar_radius *= scale, dot.post_radius *= scale;
  }
  return target;
}

bool is_same(const RigidTransform& a, const RigidTransform& b) {
  return a.rotation == b.rotation && a.translation_mm == b.translation_mm;
}

void expect_precise(const FrameResult& result, const host::Pose& truth, double scale) {
  ASSERT_TRUE(result.valid) << reason_name(result.reason);
  EXPECT_EQ(result.reason, Reason::kNone);
  const PoseErrors e = errors_of(result.pose.camera_from_target, truth);
  const double distances = std::pow(truth.t.norm() / scale / 300, 2);
  EXPECT_LE(e.rotation_deg, 0.015 * distances);
  EXPECT_LE(e.translation_mm, 0.2 * distances * scale);
}

TEST(Targets, CleanFramesGivePrecisePoses) {
  for (const double distance_mm : {300.0, 600.0, 1200.0}) {
    for (const double tilt_deg : {0.0, 20.0, 38.0}) {
      SCOPED_TRACE(std::to_string(distance_mm) + " mm, " + std::to_string(tilt_deg) + " deg");
      const host::Pose pose = pose_at(distance_mm, tilt_deg, 25);
      expect_precise(process(clean_frame(host::default_target(), pose)), pose, 1);
    }
  }
}

TEST(Targets, EqualImagesGiveEqualBits) {
  const host::Image8 image = clean_frame(host::default_target(), pose_at(500, 15, 200));
  const FrameResult once = process(image);
  process(painted([](int x, int y) { return (x ^ y) & 255; }));  // soil the workspace
  const FrameResult again = process(image);
  EXPECT_TRUE(std::equal(std::begin(once.digests), std::end(once.digests), again.digests));
  EXPECT_TRUE(is_same(once.pose.camera_from_target, again.pose.camera_from_target));
}

TEST(Targets, BlackOnWhiteIsTheComplementBitForBit) {
  Target target = host::default_target();
  host::Image8 image = clean_frame(target, pose_at(450, 25, 300));
  const FrameResult white = process(image);
  for (auto& pixel : image.data) pixel = static_cast<std::uint8_t>(255 - pixel);
  target.white_on_black = false;
  const FrameResult black = process(image, host::default_camera(), target);
  ASSERT_TRUE(white.valid && black.valid);
  EXPECT_TRUE(is_same(white.pose.camera_from_target, black.pose.camera_from_target));
}

TEST(Targets, RenderedBlackOnWhite) {
  Target target = host::default_target();
  target.white_on_black = false;
  const host::Pose pose = pose_at(600, 20, 70);
  const host::Image8 image = clean_frame(target, pose);
  expect_precise(process(image, host::default_camera(), target), pose, 1);
  EXPECT_FALSE(process(image).valid);  // the description says white on black
}

TEST(Targets, AQuarterAndFourTimesTheSize) {
  for (const double scale : {0.25, 0.5, 2.0, 4.0}) {
    for (const double tilt_deg : {0.0, 30.0}) {
      SCOPED_TRACE(std::to_string(scale) + " at " + std::to_string(tilt_deg) + " deg");
      const Target target = scaled(scale);
      const host::Pose pose = pose_at(600 * scale, tilt_deg, 130);
      const FrameResult result = process(clean_frame(target, pose), host::default_camera(), target);
      expect_precise(result, pose, scale);
    }
  }
}

void expect_valid(const host::Scene& scene, const Target& target) {
  const FrameResult result = process(host::render_frame(scene, host::default_camera(), target),
                                     host::default_camera(), target);
  EXPECT_TRUE(result.valid) << reason_name(result.reason);
  const PoseErrors e = errors_of(result.pose.camera_from_target, scene.pose);
  EXPECT_LE(e.rotation_deg, 2);
  EXPECT_LE(e.translation_mm, 0.02 * scene.pose.t.norm());
}

/// Scenes near and far, in both polarities.
template <typename Change>
void expect_valid_in(Change change) {
  for (const bool white_on_black : {true, false}) {
    Target target = host::default_target();
    target.white_on_black = white_on_black;
    for (const double distance_mm : {330.0, 700.0, 1400.0}) {
      for (const double tilt_deg : {0.0, 30.0}) {
        SCOPED_TRACE(std::to_string(distance_mm) + " mm, " + std::to_string(tilt_deg) + " deg" +
                     (white_on_black ? "" : ", black on white"));
        host::Scene scene = host::clean_scene(pose_at(distance_mm, tilt_deg, 40));
        change(scene);
        expect_valid(scene, target);
      }
    }
  }
}

// Gamma moves all edges by a share of the blur: sizes differ from the description, but alike.
TEST(Exposure, GammaSharpAndBlurred) {
  for (const double gamma : {0.45, 0.7, 1.4, 2.2}) {
    for (const double blur_px : {0.5, 1.2, 2.0}) {
      SCOPED_TRACE("gamma " + std::to_string(gamma) + ", blur " + std::to_string(blur_px));
      expect_valid_in([&](host::Scene& scene) {
        scene.optics.gamma = gamma;
        scene.optics.defocus_px = blur_px;
      });
    }
  }
}

TEST(Exposure, GammaInMotion) {
  for (const double gamma : {0.45, 2.2}) {
    for (const double direction_rad : {0.0, 0.7, 1.4}) {
      for (const double distance_mm : {330.0, 700.0, 1400.0}) {
        SCOPED_TRACE("gamma " + std::to_string(gamma) + ", " + std::to_string(distance_mm) + " mm");
        host::Scene scene = host::clean_scene(pose_at(distance_mm, 20, 40));
        scene.optics.gamma = gamma;
        scene.optics.motion_px = 6;
        scene.optics.motion_angle_rad = direction_rad;
        expect_valid(scene, host::default_target());
      }
    }
  }
}

TEST(Exposure, ClippedWhite) {
  for (const double blur_px : {0.5, 2.0}) {
    SCOPED_TRACE(blur_px);
    expect_valid_in([&](host::Scene& scene) {
      scene.light.white_dn = 330;
      scene.optics.defocus_px = blur_px;
    });
  }
}

TEST(Exposure, Dim) {
  for (const double noise_dn : {1.0, 3.0}) {
    SCOPED_TRACE(noise_dn);
    expect_valid_in([&](host::Scene& scene) {
      scene.light.white_dn = 40;
      scene.light.black_dn = 10;
      scene.noise_dn = noise_dn;
    });
  }
}

TEST(Exposure, StrayLight) {
  expect_valid_in([](host::Scene& scene) {
    scene.light.white_dn = 120;
    scene.light.black_dn = 60;
    scene.light.stray_dn = 55;
  });
}

TEST(Exposure, VignettingAtTheCorner) {
  for (const double loss : {0.3, 0.7}) {
    SCOPED_TRACE(loss);
    expect_valid_in([&](host::Scene& scene) {
      scene.optics.vignetting = loss;
      const double z = scene.pose.t.z();
      const double aside = z < 500 ? 0.12 : 0.26;  // of the distance: the whole plate is seen
      scene.pose.t = {aside * z, -aside * z, z};
    });
  }
}

TEST(Exposure, LightFromTheSide) {
  expect_valid_in([](host::Scene& scene) {
    scene.light.gradient_ratio = 4;
    scene.light.gradient_angle_rad = 0.6;
  });
}

TEST(Targets, WithoutTheLine) {
  for (const double tilt_deg : {0.0, 25.0}) {
    host::Scene scene = host::clean_scene(pose_at(500, tilt_deg, 60));
    scene.occluders.push_back(
        {"line", -0.1, {{-30, 40}, {30, 40}, {30, 50}, {-30, 50}}, scene.light.black_dn});
    const FrameResult result =
        process(host::render_frame(scene, host::default_camera(), host::default_target()));
    EXPECT_FALSE(result.valid);
    EXPECT_FALSE(result.identified);
    EXPECT_EQ(result.reason, Reason::kNoLine) << reason_name(result.reason);
  }
}

TEST(Targets, LineInTheWrongPlace) {
  Target wrong = host::default_target();
  wrong.line.center = {0, 37};
  EXPECT_FALSE(process(clean_frame(wrong, pose_at(500, 10, 60))).identified);
  wrong.line.center = {0, 53};
  EXPECT_FALSE(process(clean_frame(wrong, pose_at(500, 10, 60))).identified);
  wrong = host::default_target();
  wrong.line.center = {31.8, 31.8};
  wrong.line.length = 20;
  wrong.line.angle_deg = 135;
  EXPECT_FALSE(process(clean_frame(wrong, pose_at(500, 10, 60))).identified);
}

/// A target that is not its own mirror image (CT-1 is).
Target chiral() {
  Target target = host::default_target();
  target.dots[2].center = {45, -20, 0};
  target.dots[3].center = {-45, 20, 0};
  return target;
}

TEST(Targets, MirroredTargetsAreRefused) {
  const Target target = chiral();
  Target mirrored = target;
  for (host::Dot& dot : mirrored.dots) dot.center[0] = -dot.center[0];
  for (const double tilt_deg : {0.0, 20.0}) {
    const host::Pose pose = pose_at(500, tilt_deg, 10);
    const FrameResult right = process(clean_frame(target, pose), host::default_camera(), target);
    EXPECT_TRUE(right.valid) << reason_name(right.reason);
    const FrameResult wrong = process(clean_frame(mirrored, pose), host::default_camera(), target);
    EXPECT_FALSE(wrong.valid);
    EXPECT_FALSE(wrong.identified);
  }
}

TEST(Targets, RingAlone) {
  const FrameResult result = process(painted([](int x, int y) {
    const double r = std::hypot(x - 500, y - 510);
    return r > 48 && r < 60 ? 200 : 30;
  }));
  EXPECT_FALSE(result.identified);
  EXPECT_EQ(result.reason, Reason::kNoLine) << reason_name(result.reason);
}

}  // namespace
}  // namespace berth::test
