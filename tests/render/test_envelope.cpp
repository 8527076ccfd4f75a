// The sampled scenes against the distribution of the operating envelope.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>

#include "host_sim/io/camera_file.hpp"
#include "host_sim/render/outline.hpp"
#include "host_sim/render/sample_pose.hpp"
#include "host_sim/render/sample_scene.hpp"

namespace berth::host {
namespace {

constexpr int kCount = 4000;

std::vector<Scene> draw_scenes(int count, const SceneOptions& options = {}) {
  const Camera camera = default_camera();
  const Target target = default_target();
  std::vector<Scene> scenes;
  for (int i = 0; i < count; ++i) {
    scenes.push_back(sample_scene(options, static_cast<uint64_t>(i), camera, target));
  }
  return scenes;
}

const std::vector<Scene>& scenes() {
  static const std::vector<Scene> kScenes = draw_scenes(kCount);
  return kScenes;
}

double share(const std::vector<Scene>& drawn, const std::function<bool(const Scene&)>& has) {
  const auto hits = std::count_if(drawn.begin(), drawn.end(), has);
  return static_cast<double>(hits) / static_cast<double>(drawn.size());
}

// The values, brought to (0, 1), must be evenly spread there: the whole and a short prefix.
void expect_uniform(const std::function<double(const Scene&)>& unit_value, double tolerance) {
  for (const size_t count : {size_t{250}, size_t{kCount}}) {
    std::vector<double> values;
    for (size_t i = 0; i < count; ++i) values.push_back(unit_value(scenes()[i]));
    std::sort(values.begin(), values.end());
    double distance = 0;
    for (size_t i = 0; i < count; ++i) {
      const double expected = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
      distance = std::max(distance, std::abs(values[i] - expected));
    }
    EXPECT_GE(values.front(), 0.0);
    EXPECT_LE(values.back(), 1.0);
    EXPECT_LT(distance, count == kCount ? tolerance : 4.0 * tolerance) << count << " scenes";
  }
}

TEST(Envelope, PoseFollowsItsViewpoint) {
  for (int i = 0; i < 500; ++i) {
    const Scene& scene = scenes()[static_cast<size_t>(i)];
    const Pose& pose = scene.pose;
    EXPECT_NEAR((pose.R * pose.R.transpose() - Eigen::Matrix3d::Identity()).norm(), 0.0, 1e-14);
    EXPECT_NEAR(pose.R.determinant(), 1.0, 1e-14);
    EXPECT_NEAR(pose.t.norm(), scene.viewpoint.distance_mm, 1e-9);
    const Eigen::Vector3d normal = pose.R * Eigen::Vector3d(0, 0, -1);
    const double tilt = std::acos(std::min(1.0, normal.dot(-pose.t.normalized())));
    EXPECT_NEAR(tilt * 180.0 / 3.14159265358979, scene.viewpoint.tilt_deg, 1e-5);
    const Eigen::Vector2d center = project(default_camera(), pose.t);
    EXPECT_NEAR(center.x(), scene.viewpoint.center_px[0], 1e-8);
    EXPECT_NEAR(center.y(), scene.viewpoint.center_px[1], 1e-8);
  }
}

TEST(Envelope, WholeTargetIsAlwaysInTheImage) {
  const Camera camera = default_camera();
  for (const Scene& scene : scenes()) {
    ASSERT_TRUE(scene.is_plate_inside);
    for (const Eigen::Vector2d& p : project_plate({camera, scene.pose}, default_target())) {
      ASSERT_GE(p.minCoeff(), 0.0);
      ASSERT_LE(p.maxCoeff(), 1023.0);
    }
  }
}

TEST(Envelope, PoseIsSpreadAsStated) {
  expect_uniform(
      [](const Scene& s) { return std::log(s.viewpoint.distance_mm / 300) / std::log(5); }, 0.002);
  expect_uniform([](const Scene& s) { return s.viewpoint.tilt_deg / 40; }, 0.002);
  expect_uniform([](const Scene& s) { return s.viewpoint.tilt_direction_deg / 360; }, 0.002);
  expect_uniform([](const Scene& s) { return s.viewpoint.roll_deg / 360 + 0.5; }, 0.002);
}

TEST(Envelope, OpticsAreSpreadAsStated) {
  expect_uniform([](const Scene& s) { return (s.noise_dn - 0.5) / 5.5; }, 0.002);
  expect_uniform([](const Scene& s) { return (s.optics.defocus_px - 0.4) / 1.6; }, 0.002);
  expect_uniform([](const Scene& s) { return s.optics.motion_px / 6; }, 0.002);
  expect_uniform([](const Scene& s) { return s.optics.motion_angle_rad / 3.14159265359; }, 0.002);
  for (const Scene& s : scenes()) {
    ASSERT_EQ(s.optics.gamma, 1.0);
    ASSERT_EQ(s.optics.vignetting, 0.0);
  }
}

TEST(Envelope, LevelsAreSpreadAsStated) {
  expect_uniform([](const Scene& s) { return (s.light.black_dn - 2) / 58; }, 0.002);
  expect_uniform(
      [](const Scene& s) {
        const Light& l = s.light;
        if (l.white_dn > 255) return (l.white_dn - 255) / 75;
        const double low = std::max(40.0, l.black_dn + 30);
        return (l.white_dn - low) / (255 - low);
      },
      0.03);
  EXPECT_NEAR(share(scenes(), [](const Scene& s) { return s.light.white_dn > 255; }), 0.1, 0.005);
  for (const Scene& s : scenes()) {
    ASSERT_GE(s.contrast_dn(), 30.0 - 1e-9);
    ASSERT_GE(s.light.stray_dn, 0.0);
    ASSERT_LE(s.light.stray_dn, s.light.black_dn);
    ASSERT_LE(s.light.gradient_ratio, 4.0);
  }
}

TEST(Envelope, SharesOfHazards) {
  for (const auto& drawn :
       {scenes(), std::vector<Scene>(scenes().begin(), scenes().begin() + 500)}) {
    const double tolerance = drawn.size() == kCount ? 0.005 : 0.02;
    const auto expect_share = [&](double expected, const std::function<bool(const Scene&)>& has) {
      EXPECT_NEAR(share(drawn, has), expected, tolerance);
    };
    expect_share(0.2, [](const Scene& s) { return !s.occluders.empty(); });
    expect_share(0.2, [](const Scene& s) { return s.light.shadow.has_value(); });
    expect_share(0.2, [](const Scene& s) { return !s.glints.empty(); });
    expect_share(0.3, [](const Scene& s) { return s.light.gradient_ratio > 1.0; });
    expect_share(0.2, [](const Scene& s) { return s.background.kind == BackgroundKind::kDark; });
    expect_share(0.1, [](const Scene& s) { return s.background.kind == BackgroundKind::kBright; });
    expect_share(0.7, [](const Scene& s) { return s.background.kind == BackgroundKind::kClutter; });
  }
}

TEST(Envelope, HazardsKeepTheirLimits) {
  for (const Scene& s : scenes()) {
    ASSERT_LE(s.occluders.size(), 1u);
    ASSERT_LE(s.glints.size(), 1u);
    for (const Glint& glint : s.glints) ASSERT_LE(glint.radius_mm, 6.0);
    if (s.light.shadow) {
      ASSERT_GE(s.light.shadow->leaves, 0.3);
      ASSERT_LE(s.light.shadow->leaves, 0.8);
    }
  }
  for (const char* name : {"ring", "line", "D0", "D1", "D2", "D3", "D4"}) {
    EXPECT_GT(share(scenes(), [name](const Scene& s) { return s.hidden_marker() == name; }), 0.005)
        << name;
  }
}

// At a fixed distance and attitude the places that hold the plate are one region; the images of
// the centre must fill it evenly.
TEST(Envelope, PositionIsUniformWhereThePlateFits) {
  SceneOptions options;
  options.distance_mm = 400;
  options.tilt_deg = 25;
  options.tilt_direction_deg = 30;
  options.roll_deg = 20;
  constexpr int kCells = 6;
  constexpr int kDraws = 3000;
  const Camera camera = default_camera();
  std::vector<double> expected(kCells * kCells, 0.0);
  std::vector<double> drawn(kCells * kCells, 0.0);
  const auto cell_of = [](double u, double v) {
    return static_cast<size_t>(v * kCells / 1024) * kCells + static_cast<size_t>(u * kCells / 1024);
  };
  double fitting = 0;
  for (double v = 4; v < 1024; v += 8) {
    for (double u = 4; u < 1024; u += 8) {
      const Pose pose = pose_from_viewpoint({400, 25, 30, 20, {u, v}}, camera);
      if (!is_inside_image({camera, pose}, default_target())) continue;
      expected[cell_of(u, v)] += 1;
      fitting += 1;
    }
  }
  for (const Scene& s : draw_scenes(kDraws, options)) {
    drawn[cell_of(s.viewpoint.center_px[0], s.viewpoint.center_px[1])] += 1;
  }
  for (size_t i = 0; i < expected.size(); ++i) {
    const double mean = kDraws * expected[i] / fitting;
    EXPECT_NEAR(drawn[i], mean, 3.5 * std::sqrt(mean) + 4.0) << "cell " << i;
  }
}

TEST(Envelope, DistancesScaleWithTheTarget) {
  Target target = default_target();
  target.plate_size_mm = {30.0, 30.0};
  EXPECT_DOUBLE_EQ(distance_range(target).nearest_mm, 75.0);
  EXPECT_DOUBLE_EQ(distance_range(target).farthest_mm, 375.0);
}

TEST(Envelope, TooNearIsReported) {
  SceneOptions options;
  options.distance_mm = 120;
  EXPECT_FALSE(sample_scene(options, 0, default_camera(), default_target()).is_plate_inside);
}

TEST(Envelope, CleanScenesAreClean) {
  SceneOptions options;
  options.clean = true;
  for (const Scene& s : draw_scenes(50, options)) {
    EXPECT_EQ(s.light.white_dn, 200);
    EXPECT_EQ(s.light.black_dn, 30);
    EXPECT_EQ(s.light.gradient_ratio, 1);
    EXPECT_EQ(s.noise_dn, 2);
    EXPECT_EQ(s.optics.defocus_px, 0.7);
    EXPECT_EQ(s.optics.motion_px, 0);
    EXPECT_FALSE(s.light.shadow.has_value());
    EXPECT_TRUE(s.occluders.empty() && s.glints.empty());
    EXPECT_TRUE(s.background.kind == BackgroundKind::kPlain);
  }
}

}  // namespace
}  // namespace berth::host
