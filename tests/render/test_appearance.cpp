// What the light, the occluders and the missing target do to the image.
#include <gtest/gtest.h>

#include <cmath>

#include "host_sim/render/det_math.hpp"
#include "host_sim/render/outline.hpp"
#include "host_sim/render/render.hpp"
#include "host_sim/render/sample_hazards.hpp"
#include "host_sim/render/sample_pose.hpp"
#include "host_sim/render/sample_scene.hpp"

namespace berth::host {
namespace {

class Appearance : public ::testing::Test {
 protected:
  Appearance() {
    scene = clean_scene(pose_from_viewpoint({300, 10, 40, 30, {500, 520}}, camera));
    scene.light.stray_dn = 20.0;
  }

  std::vector<float> rendered() const {
    std::vector<float> image;
    render(scene, camera, target, image);
    return image;
  }

  float level_at(const std::vector<float>& image, double x_mm, double y_mm, double z_mm = 0) const {
    const Eigen::Vector2d p = project_point({camera, scene.pose}, {x_mm, y_mm, z_mm});
    return image[static_cast<size_t>(std::lround(p.y())) * 1024 +
                 static_cast<size_t>(std::lround(p.x()))];
  }

  // White area of an image, in pixels, over what the bare plate shows.
  double white_area(const std::vector<float>& image, const std::vector<float>& bare) const {
    double sum = 0;
    for (size_t i = 0; i < image.size(); ++i) sum += image[i] - bare[i];
    return sum / 170.0;
  }

  Camera camera = default_camera();
  Target target = default_target();
  Scene scene;
};

TEST_F(Appearance, LevelsAreThoseOfTheScene) {
  const std::vector<float> image = rendered();
  EXPECT_NEAR(level_at(image, 45, 45), 200, 0.01);
  EXPECT_NEAR(level_at(image, 0, 0, -20), 200, 0.01);
  EXPECT_NEAR(level_at(image, 27, 0), 200, 0.01);
  EXPECT_NEAR(level_at(image, 40, 0), 30, 0.01);
  EXPECT_NEAR(image[0], 115, 0.01);
}

TEST_F(Appearance, GradientFallsLinearlyAcrossThePlate) {
  scene.light.gradient_ratio = 3.0;
  scene.light.gradient_angle_rad = 0.6;
  const std::vector<float> image = rendered();
  const double extent = 60 * (std::cos(0.6) + std::sin(0.6));
  for (const Dot& dot : target.dots) {
    if (dot.center[2] != 0.0) continue;
    const double s = dot.center[0] * std::cos(0.6) + dot.center[1] * std::sin(0.6);
    const double factor = 1.0 - (1.0 - 1.0 / 3.0) * (extent - s) / (2.0 * extent);
    EXPECT_NEAR(level_at(image, dot.center[0], dot.center[1]), 20 + 180 * factor, 0.7) << dot.name;
  }
  EXPECT_NEAR(scene.contrast_dn(), 170.0 / 3.0, 1e-9);
}

TEST_F(Appearance, ShadowLeavesItsShareBeyondItsEdge) {
  scene.light.shadow = Shadow{1, 0, 5, 0, 0.4};
  const std::vector<float> image = rendered();
  EXPECT_NEAR(level_at(image, -45, 45), 200, 0.01);
  EXPECT_NEAR(level_at(image, 45, 45), 20 + 0.4 * 180, 0.01);
  EXPECT_NEAR(level_at(image, 45, 0), 20 + 0.4 * 10, 0.01);
  EXPECT_NEAR(level_at(image, 5, 45), 20 + 0.7 * 180,
              15);                                // on the edge, in the middle of the line
  EXPECT_NEAR(scene.contrast_dn(), 170.0, 1e-9);  // contrast is that of the lit part
}

TEST_F(Appearance, OccludersHideWhatTheySay) {
  scene.light.stray_dn = 0.0;
  const auto area_without = [this](const Occluder* occluder) {
    scene.occluders.clear();
    if (occluder != nullptr) scene.occluders.push_back(*occluder);
    if (occluder != nullptr) scene.occluders[0].level_dn = scene.light.black_dn;
    const std::vector<float> image = rendered();
    Target bare = target;
    bare.dots.clear();
    bare.ring = {1e-6, 0.0};
    bare.line.length = bare.line.width = 1e-6;
    std::vector<float> plate;
    render(scene, camera, bare, plate);
    return white_area(image, plate);
  };
  const double all = area_without(nullptr);
  const double px2_per_mm2 = all / (4 * 36 * kPi + 36 * kPi + (900 - 576) * kPi + 56 * 6);
  const auto hidden_mm2 = [&](const Occluder& o) { return (all - area_without(&o)) / px2_per_mm2; };
  EXPECT_NEAR(hidden_mm2(occlude_ring(target.ring, 0.3)), 324 * kPi / 4, 20);
  EXPECT_NEAR(hidden_mm2(occlude_line(target.line, 1)), 168, 15);
  EXPECT_NEAR(hidden_mm2(occlude_line(target.line, -1)), 168, 15);
  EXPECT_NEAR(hidden_mm2(occlude_dot(target.dots[2], 0.4)), 36 * kPi, 10);
  EXPECT_NEAR(hidden_mm2(occlude_dot(target.dots[0], 0.4)), 36 * kPi, 20);
}

TEST_F(Appearance, WithoutTargetOnlyThePlateIsGone) {
  for (uint64_t index = 0; index < 6; ++index) {
    SceneOptions options;
    options.seed = 9;
    scene = sample_scene(options, index, camera, target);
    const std::vector<float> with = rendered();
    options.with_target = false;
    const Scene without_scene = sample_scene(options, index, camera, target);
    EXPECT_EQ(without_scene.noise_seed, scene.noise_seed);
    std::vector<float> without;
    render(without_scene, camera, target, without);
    const Polygon plate = project_plate({camera, scene.pose}, target);
    const Grid reach = grid_around(plate, 18, 1, {0, 0, 1024, 1024, 1});
    for (int y = 0; y < 1024; ++y) {
      for (int x = 0; x < 1024; ++x) {
        const bool is_near = x >= reach.x0_px && x < reach.x0_px + reach.width &&
                             y >= reach.y0_px && y < reach.y0_px + reach.height;
        const size_t i = static_cast<size_t>(y) * 1024 + static_cast<size_t>(x);
        if (!is_near) {
          ASSERT_EQ(with[i], without[i]);
        }
      }
    }
  }
}

TEST_F(Appearance, NoTraceOfTheTargetOnPlainGround) {
  scene.has_target = false;
  for (const float value : rendered()) ASSERT_NEAR(value, 115.0f, 1e-3f);
}

TEST_F(Appearance, GammaAndVignettingActOnTheSignal) {
  scene.light.stray_dn = 0.0;
  scene.optics.gamma = 0.5;
  scene.optics.vignetting = 0.3;
  const std::vector<float> image = rendered();
  const double corner = 255.0 * std::sqrt(115.0 * 0.7 / 255.0);
  EXPECT_NEAR(image[0], corner, 0.1);
}

TEST_F(Appearance, GlintAddsLightWithinItsRadius) {
  const std::vector<float> plain = rendered();
  scene.glints.push_back({10, 35, 4, 500});
  const std::vector<float> image = rendered();
  EXPECT_GT(level_at(image, 10, 35), level_at(plain, 10, 35) + 400);
  EXPECT_NEAR(level_at(image, 10, 41), level_at(plain, 10, 41), 0.5);
}

TEST(Quantise, RoundsToNearestAndClips) {
  const std::vector<float> values{-3.0f, 0.49f, 0.51f, 100.49f, 100.51f, 254.6f, 300.0f, 330.0f};
  const Image8 image = quantise(values, 8, 1, 0.0, 1);
  EXPECT_EQ(image.data, (std::vector<uint8_t>{0, 0, 1, 100, 101, 255, 255, 255}));
}

TEST(Quantise, NoiseHasItsVarianceAndDrawsDiffer) {
  const std::vector<float> values(512 * 512, 100.3f);
  const Image8 a = quantise(values, 512, 512, 2.0, 1);
  const Image8 b = quantise(values, 512, 512, 2.0, 2);
  double sum = 0, sum2 = 0, product = 0;
  for (size_t i = 0; i < values.size(); ++i) {
    const double ea = a.data[i] - 100.3;
    const double eb = b.data[i] - 100.3;
    sum += ea;
    sum2 += ea * ea;
    product += ea * eb;
  }
  const double count = 512.0 * 512.0;
  EXPECT_NEAR(sum / count, 0.0, 0.02);
  EXPECT_NEAR(sum2 / count, 4.0 + 1.0 / 12.0, 0.06);
  EXPECT_NEAR(product / count, 0.0, 0.04);
}

}  // namespace
}  // namespace berth::host
