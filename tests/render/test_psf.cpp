// Laws of the optics' kernels: unit sum, symmetry, and the stated variance.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "host_sim/render/psf.hpp"

namespace berth::host {
namespace {

struct Moments {
  double sum = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
};

Moments moments_of(const std::vector<Tap>& taps) {
  Moments m;
  for (const Tap& t : taps) {
    const double w = t.weight;
    m.sum += w;
    m.x += w * t.dx;
    m.y += w * t.dy;
    m.xx += w * t.dx * t.dx;
    m.xy += w * t.dx * t.dy;
    m.yy += w * t.dy * t.dy;
  }
  return m;
}

double variance_of(const Kernel& kernel) {
  double sum = 0;
  const int reach = static_cast<int>(kernel.size() / 2);
  for (int i = -reach; i <= reach; ++i) {
    sum += static_cast<double>(kernel[static_cast<size_t>(i + reach)]) * i * i;
  }
  return sum;
}

void expect_unit_and_symmetric(const Kernel& kernel) {
  double sum = 0;
  for (size_t i = 0; i < kernel.size(); ++i) {
    sum += kernel[i];
    EXPECT_EQ(kernel[i], kernel[kernel.size() - 1 - i]);
  }
  EXPECT_NEAR(sum, 1.0, 1e-6);
}

TEST(Psf, GaussianHasItsVariance) {
  for (const double sigma : {0.0, 0.2, 0.4, 0.79, 0.81, 1.6, 2.8, 8.0}) {
    const Kernel kernel = gaussian_kernel(sigma * sigma);
    expect_unit_and_symmetric(kernel);
    EXPECT_NEAR(variance_of(kernel), sigma * sigma, 2e-4 * sigma * sigma) << sigma;
  }
}

TEST(Psf, BoxHasItsVariance) {
  // Shared between cells, a box gains a cell's variance, more or less what its ends decide.
  for (const double width : {1.0, 3.0, 5.5, 12.0}) {
    const Kernel kernel = box_kernel(width);
    expect_unit_and_symmetric(kernel);
    EXPECT_NEAR(variance_of(kernel), (width * width + 1.0) / 12.0, 0.17) << width;
  }
}

TEST(Psf, DiscHasItsVariance) {
  for (const double radius : {3.0, 8.0, 16.0}) {
    const Moments m = moments_of(disc_taps(radius));
    EXPECT_NEAR(m.sum, 1.0, 1e-5);
    EXPECT_NEAR(m.x, 0.0, 1e-6);
    EXPECT_NEAR(m.y, 0.0, 1e-6);
    EXPECT_NEAR(m.xx, radius * radius / 4.0 + 1.0 / 12.0, 0.05);
    EXPECT_NEAR(m.yy, radius * radius / 4.0 + 1.0 / 12.0, 0.05);
    EXPECT_NEAR(m.xy, 0.0, 1e-5);
  }
}

TEST(Psf, MotionHasItsLengthAndDirection) {
  for (const double length : {0.5, 1.0, 2.6, 4.0, 11.3, 24.0}) {
    for (double angle = 0.0; angle < 3.2; angle += 0.1) {
      for (const int spacing : {1, 2}) {
        const MotionTaps motion = motion_taps(length, angle, spacing);
        const Moments m = moments_of(motion.taps);
        const double along = length * length / 12.0;
        const double c = std::cos(angle), s = std::sin(angle);
        EXPECT_NEAR(m.sum, 1.0, 1e-6);
        EXPECT_NEAR(m.x, 0.0, 1e-6);
        EXPECT_NEAR(m.y, 0.0, 1e-6);
        EXPECT_NEAR(m.xx - motion.excess_x, along * c * c, 1e-5 * (1.0 + along));
        EXPECT_NEAR(m.yy - motion.excess_y, along * s * s, 1e-5 * (1.0 + along));
        EXPECT_NEAR(m.xy, along * c * s, 1e-5 * (1.0 + along));
      }
    }
  }
}

TEST(Psf, MotionIsPointSymmetric) {
  for (const double angle : {0.3, 1.2, 2.0}) {
    std::map<std::pair<int, int>, float> weights;
    for (const Tap& t : motion_taps(17.3, angle, 2).taps) weights[{t.dx, t.dy}] += t.weight;
    for (const auto& [offset, weight] : weights) {
      const auto mirrored = weights.find({-offset.first, -offset.second});
      ASSERT_NE(mirrored, weights.end());
      EXPECT_EQ(mirrored->second, weight);
    }
  }
}

TEST(Psf, KindsShareTheirVariance) {
  for (const PsfKind kind : {PsfKind::kGaussian, PsfKind::kBox, PsfKind::kDisc}) {
    Optics optics;
    optics.psf = kind;
    optics.defocus_px = 1.5;
    optics.motion_px = 4.0;
    optics.motion_angle_rad = 0.7;
    const Psf psf = make_psf(optics, 4);
    const Moments m = moments_of(psf.taps);
    const double c = std::cos(0.7);
    EXPECT_NEAR((m.xx + variance_of(psf.x)) / 16.0, 2.25 + 16.0 / 12.0 * c * c, 0.02);
  }
}

}  // namespace
}  // namespace berth::host
