// Projection and undistortion against cv::projectPoints, and their laws.
#include <gtest/gtest.h>

#include <algorithm>

#include "camera/projection.hpp"
#include "cameras.hpp"

namespace berth_test {
namespace {

using berth::Vec2Px;
using berth::Vec2Ray;
using berth::Vec3Mm;

// A pixel of the image and a point on its ray at 75 to 4000 mm.
struct Sample {
  Vec2Px pixel;
  Vec3Mm point;
};

Sample random_sample(Random& random, const berth::Camera& camera) {
  Sample s;
  s.pixel = {nearest<16>(random.uniform(-0.5, 1023.5)), nearest<16>(random.uniform(-0.5, 1023.5))};
  const Vec2Ray ray = berth::undistort(camera, s.pixel);
  const double z = 75 * std::pow(53.0, random.uniform(0, 1));
  s.point = {nearest<18>(real(ray[0]) * z), nearest<18>(real(ray[1]) * z), nearest<18>(z)};
  return s;
}

cv::Point3d real_point(const Vec3Mm& p) { return {real(p[0]), real(p[1]), real(p[2])}; }

// Stated relative error of the Jacobians: 2^-16 near the axis.
double jacobian_tolerance(const Vec2Ray& ray) {
  const double r2 = real(ray).squaredNorm();
  return 0x1p-16 * (1 + r2) * (1 + r2);
}

double distance(const cv::Point2d& a, const Vec2Px& b) {
  return std::max(std::abs(a.x - real(b[0])), std::abs(a.y - real(b[1])));
}

class Projection : public testing::TestWithParam<NamedCamera> {};

TEST_P(Projection, AgreesWithOpenCv) {
  const CvCamera reference(GetParam().camera);
  Random random;
  double worst = 0;
  for (int i = 0; i < 40000; ++i) {
    const Sample s = random_sample(random, GetParam().camera);
    const cv::Point2d expected = reference.project(real_point(s.point));
    worst = std::max(worst, distance(expected, berth::project(GetParam().camera, s.point)));
  }
  RecordProperty("worst_px", std::to_string(worst));
  EXPECT_LE(worst, 0x1p-14);
}

TEST_P(Projection, JacobianAgreesWithOpenCv) {
  const CvCamera reference(GetParam().camera);
  Random random;
  double worst = 0;
  for (int i = 0; i < 20000; ++i) {
    const Sample s = random_sample(random, GetParam().camera);
    if (real(s.point[2]) * 100 < real(GetParam().camera.fx)) continue;  // above 100 px/mm
    cv::Matx23d expected;
    const cv::Point2d pixel = reference.project(real_point(s.point), &expected);
    const berth::Projection p = berth::project_with_jacobian(GetParam().camera, s.point);
    EXPECT_LE(distance(pixel, p.pixel), 0x1p-14);
    for (int k = 0; k < 6; ++k) {
      const double error = real(p.by_point(k / 3, k % 3)) - expected(k / 3, k % 3);
      worst = std::max(worst, std::abs(error) / (cv::norm(expected) * jacobian_tolerance(p.ray)));
    }
  }
  EXPECT_LE(worst, 1);
}

TEST_P(Projection, UndistortionReturnsToThePixel) {
  const CvCamera reference(GetParam().camera);
  double worst = 0;
  for (double v = -0.5; v <= 1023.5; v += 7.87) {
    for (double u = -0.5; u <= 1023.5; u += 7.87) {
      const Vec2Px pixel{nearest<16>(u), nearest<16>(v)};
      const Vec2Ray ray = berth::undistort(GetParam().camera, pixel);
      const cv::Point2d back = reference.project({real(ray[0]), real(ray[1]), 1});
      worst = std::max(worst, distance(back, pixel));
    }
  }
  RecordProperty("worst_px", std::to_string(worst));
  EXPECT_LE(worst, 0x1p-14);
}

TEST_P(Projection, OneStepFromANeighbourIsQuadratic) {
  Random random;
  for (int i = 0; i < 2000; ++i) {
    const Sample s = random_sample(random, GetParam().camera);
    const Vec2Px near{s.pixel[0] + berth::Px(1), s.pixel[1] - berth::Px(2)};
    const Vec2Ray start = berth::undistort(GetParam().camera, near);
    const Vec2Ray ray = berth::undistort_from(GetParam().camera, s.pixel, start);
    const Vec2Px back = berth::distort_to_pixel(GetParam().camera, ray);
    EXPECT_LE((real(back) - real(s.pixel)).cwiseAbs().maxCoeff(), 0.01);
  }
}

TEST_P(Projection, RayJacobianIsThatOfDifferences) {
  Random random;
  const CvCamera reference(GetParam().camera);
  for (int i = 0; i < 2000; ++i) {
    const Sample s = random_sample(random, GetParam().camera);
    const Vec2Ray ray = berth::undistort(GetParam().camera, s.pixel);
    const berth::RayProjection p = berth::distort_with_jacobian(GetParam().camera, ray);
    constexpr double h = 1e-5;
    for (int k = 0; k < 2; ++k) {
      const double dx = k == 0 ? h : 0, dy = k == 1 ? h : 0;
      const cv::Point2d d = reference.project({real(ray[0]) + dx, real(ray[1]) + dy, 1}) -
                            reference.project({real(ray[0]) - dx, real(ray[1]) - dy, 1});
      const double tolerance = real(GetParam().camera.fx) * jacobian_tolerance(ray);
      EXPECT_NEAR(real(p.by_ray(0, k)), d.x / (2 * h), tolerance);
      EXPECT_NEAR(real(p.by_ray(1, k)), d.y / (2 * h), tolerance);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Cameras, Projection, testing::ValuesIn(valid_cameras()),
                         [](const auto& camera) { return camera.param.name; });

TEST(ProjectionLimits, TheOpticalAxisHitsThePrincipalPoint) {
  for (const NamedCamera& c : valid_cameras()) {
    const Vec2Px pixel = berth::project(c.camera, {berth::Mm(0), berth::Mm(0), berth::Mm(300)});
    EXPECT_TRUE(pixel[0] == c.camera.cx && pixel[1] == c.camera.cy) << c.name;
    EXPECT_TRUE(berth::undistort(c.camera, pixel) == Vec2Ray(berth::Ray(0), berth::Ray(0)));
  }
}

TEST(ProjectionLimits, PointsFarOutsideSaturateWithoutHarm) {
  const berth::Camera camera = valid_cameras()[1].camera;  // no distortion: monotone everywhere
  Random random;
  for (int i = 0; i < 100000; ++i) {
    const auto z = berth::Mm::from_raw(static_cast<std::int32_t>(random.bits() & 0x7fffffff) | 1);
    const Vec3Mm point{berth::Mm::from_raw(random.any32()), berth::Mm::from_raw(random.any32()), z};
    const berth::Projection p = berth::project_with_jacobian(camera, point);
    const double x = std::clamp(real(point[0]) / real(z), -2.0, 2.0);
    EXPECT_NEAR(real(p.pixel[0]), 515.3 + 1250 * x, 0.01);
  }
  EXPECT_TRUE(berth::ray_of({berth::Mm::lowest(), berth::Mm::max(), berth::Mm::from_raw(1)}) ==
              Vec2Ray(-berth::kMaxRay, berth::kMaxRay));
}

TEST(ProjectionLimits, BarrelFoldsOutsideItsField) {
  const berth::Camera barrel = make_camera(1250, -0.3, 0, 0, 0, 0);  // folds at r = 1.054
  EXPECT_TRUE(berth::is_unfolded(barrel, {nearest<28>(0.5), nearest<28>(0.5)}));
  EXPECT_FALSE(berth::is_unfolded(barrel, {nearest<28>(0.9), nearest<28>(0.9)}));
}

}  // namespace
}  // namespace berth_test
