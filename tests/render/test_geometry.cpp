// Every pixel of sharp, noise-free images against a ray caster: which part hides which.
#include <gtest/gtest.h>

#include "host_sim/render/render.hpp"
#include "host_sim/render/sample_pose.hpp"
#include "host_sim/render/sample_scene.hpp"
#include "tests/render/scene_ray_caster.hpp"

namespace berth::host {
namespace {

constexpr int kRaysPerSide = 8;

// The grey level of a pixel as the mean over its rays.
double cast_pixel(const SceneRayCaster& caster, const Camera& camera, const Scene& scene,
                  const Target& target, int x, int y) {
  // Within a pixel the lens is linear.
  const Eigen::Vector2d middle = undistort(camera, Eigen::Vector2d(x, y)).value();
  const Eigen::Vector2d right = undistort(camera, Eigen::Vector2d(x + 1, y)).value() - middle;
  const Eigen::Vector2d down = undistort(camera, Eigen::Vector2d(x, y + 1)).value() - middle;
  double sum = 0.0;
  for (int i = 0; i < kRaysPerSide * kRaysPerSide; ++i) {
    const double u = (i % kRaysPerSide + 0.5) / kRaysPerSide - 0.5;
    const double v = (i / kRaysPerSide + 0.5) / kRaysPerSide - 0.5;
    const Eigen::Vector2d ray = middle + u * right + v * down;
    const Surface surface = caster.first_surface(ray.x(), ray.y());
    if (surface == Surface::kNothing) sum += scene.background.level_dn;
    if (surface == Surface::kMarker) {
      sum += target.white_on_black ? scene.light.white_dn : scene.light.black_dn;
    }
    if (surface == Surface::kGround) {
      sum += target.white_on_black ? scene.light.black_dn : scene.light.white_dn;
    }
  }
  return sum / (kRaysPerSide * kRaysPerSide);
}

// Compares the square of `half_px` around the plate's centre.
void expect_same_image(const Viewpoint& viewpoint, const Target& target, int half_px) {
  const Camera camera = default_camera();
  Scene scene = clean_scene(pose_from_viewpoint(viewpoint, camera));
  scene.optics.defocus_px = 0.0;
  std::vector<float> image;
  render(scene, camera, target, image);
  const SceneRayCaster caster(scene.pose, target);
  const int cx = static_cast<int>(viewpoint.center_px[0]);
  const int cy = static_cast<int>(viewpoint.center_px[1]);
  double sum2 = 0.0;
  double worst = 0.0;
  for (int y = cy - half_px; y <= cy + half_px; ++y) {
    for (int x = cx - half_px; x <= cx + half_px; ++x) {
      const double error = image[static_cast<size_t>(y) * 1024 + static_cast<size_t>(x)] -
                           cast_pixel(caster, camera, scene, target, x, y);
      sum2 += error * error;
      worst = std::max(worst, std::abs(error));
    }
  }
  // 64 rays miss an edge by up to a sixteenth of a pixel in each direction.
  EXPECT_LT(worst, 0.15 * 170.0);
  EXPECT_LT(std::sqrt(sum2) / (2 * half_px + 1), 1.0);
}

TEST(Geometry, FacingTheTarget) {
  expect_same_image({900, 0, 0, 10, {500.2, 520.9}}, default_target(), 110);
}

TEST(Geometry, CollarHidesPartOfTheRing) {
  expect_same_image({900, 40, 120, 75, {300.5, 700.1}}, default_target(), 100);
}

TEST(Geometry, RaisedDotLiesOverTheRingAndPostShows) {
  expect_same_image({900, 62, 250, -20, {511.0, 400.0}}, default_target(), 90);
}

TEST(Geometry, BlackMarkersOnWhitePlate) {
  Target target = default_target();
  target.white_on_black = false;
  target.line.angle_deg = -8.0;
  expect_same_image({900, 38, 10, 160, {640.0, 500.0}}, target, 100);
}

TEST(Geometry, FlatTarget) {
  Target target = default_target();
  target.dots.erase(target.dots.begin());
  expect_same_image({900, 30, 60, 0, {200.0, 200.0}}, target, 100);
}

}  // namespace
}  // namespace berth::host
