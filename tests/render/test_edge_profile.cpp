// The profile of a blurred straight edge is that of the Gaussian, whatever the edge's place on the
// pixel grid: what is fitted to edges must not see the renderer's own grid.
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "host_sim/render/render.hpp"
#include "host_sim/render/sample_scene.hpp"

namespace berth::host {
namespace {

// Integral of the normal distribution function: the mean over a pixel is a difference of two.
double integrated_step(double x, double sigma) {
  const double u = x / sigma;
  const double density = std::exp(-0.5 * u * u) / std::sqrt(2.0 * CV_PI);
  return sigma * (u * 0.5 * std::erfc(-u / std::sqrt(2.0)) + density);
}

// Part of the pixel at `pixel` that lies beyond an edge, blurred.
double exact_part(double pixel, double edge, double sigma) {
  return integrated_step(pixel + 0.5 - edge, sigma) - integrated_step(pixel - 0.5 - edge, sigma);
}

Camera plain_camera() {
  Camera camera = default_camera();
  camera.k1 = camera.k2 = camera.p1 = camera.p2 = camera.k3 = 0.0;
  camera.width = 65;  // a strip across the line's middle
  camera.height = 512;
  camera.cx = 32.0;
  camera.cy = 255.0;
  return camera;
}

// The same, averaged over a straight motion of the edge.
double moved_part(double pixel, double edge, double sigma, double motion) {
  constexpr int kSteps = 400;
  if (motion == 0.0) return exact_part(pixel, edge, sigma);
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    sum += exact_part(pixel, edge + motion * ((i + 0.5) / kSteps - 0.5), sigma);
  }
  return sum / kSteps;
}

struct Blur {
  double sigma_px;
  double along_px;   // motion along the line, which must not change the profile across it
  double across_px;  // motion across the line
};

// Largest error of the profile across the middle of the line, relative to the contrast.
double largest_profile_error(const Blur& blur, double shift_px) {
  const Camera camera = plain_camera();
  const Target target = default_target();
  Pose pose;
  pose.t = {0.0, shift_px * 500.0 / camera.fy, 500.0};
  Scene scene = clean_scene(pose);
  scene.optics.defocus_px = blur.sigma_px;
  scene.optics.motion_px = blur.along_px + blur.across_px;
  scene.optics.motion_angle_rad = blur.across_px > 0.0 ? CV_PI / 2.0 : 0.0;
  std::vector<float> image;
  render(scene, camera, target, image);
  const double scale = camera.fy / 500.0;
  const double middle = camera.cy + shift_px + scale * target.line.center[1];
  const double half_width = 0.5 * scale * target.line.width;
  const int center_row = static_cast<int>(std::lround(middle));
  double worst = 0.0;
  for (int y = center_row - 14; y <= center_row + 14; ++y) {
    const double exact = moved_part(y, middle - half_width, blur.sigma_px, blur.across_px) -
                         moved_part(y, middle + half_width, blur.sigma_px, blur.across_px);
    const double value = image[static_cast<size_t>(y) * 65 + 32];
    const double contrast = scene.light.white_dn - scene.light.black_dn;
    worst = std::max(worst, std::abs((value - scene.light.black_dn) / contrast - exact));
  }
  return worst;
}

void expect_profile(const Blur& blur, double tolerance) {
  for (int step = 0; step < 16; ++step) {
    EXPECT_LT(largest_profile_error(blur, step / 16.0 + 0.013), tolerance) << "step " << step;
  }
}

// Axis-parallel edges are the worst case: the grid averages out along every other.
TEST(EdgeProfile, IsGaussianAtEveryPlaceOnTheGrid) {
  expect_profile({0.4, 0, 0}, 0.004);
  expect_profile({0.7, 0, 0}, 0.002);
  expect_profile({1.2, 0, 0}, 0.001);
  expect_profile({2.0, 0, 0}, 0.0005);
}

TEST(EdgeProfile, IsUntouchedByMotionAlongTheEdge) {
  expect_profile({0.7, 5, 0}, 0.002);
  expect_profile({2.0, 6, 0}, 0.0005);
}

TEST(EdgeProfile, IsWidenedByMotionAcrossTheEdge) {
  for (const double motion : {0.3, 1.0, 2.7, 4.4, 6.0}) {
    SCOPED_TRACE(motion);
    expect_profile({0.4, 0, motion}, 0.006);
    expect_profile({1.0, 0, motion}, 0.002);
  }
}

}  // namespace
}  // namespace berth::host
