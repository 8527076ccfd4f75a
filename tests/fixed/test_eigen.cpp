// Eigen's expressions over mixed Q formats, and the once-rounded products, against double.
#include <gtest/gtest.h>

#include "camera/camera.hpp"
#include "fixed/vector.hpp"
#include "reference.hpp"
// After fixed/eigen.hpp, which sets Eigen up.
#include <Eigen/Geometry>

namespace berth_test {
namespace {

using berth::Mat3Unit;
using berth::Mm;
using berth::Unit;
using berth::Vec3Mm;
using berth::Vec3Unit;

static_assert(std::is_same_v<decltype(Unit() * Mm()), Mm>);
static_assert(
    std::is_same_v<decltype(std::declval<Mat3Unit>() * std::declval<Vec3Mm>())::Scalar, Mm>);

struct Scene {
  Mat3Unit rotation;
  Vec3Unit a, b;
  Vec3Mm p, t;
};

Scene random_scene(Random& random) {
  Scene s;
  Eigen::Quaterniond q(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1), 0.1);
  const Eigen::Matrix3d rotation = q.normalized().toRotationMatrix();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) s.rotation(i, j) = nearest<30>(rotation(i, j));
    s.a[i] = nearest<30>(random.uniform(-0.7, 0.7));
    s.b[i] = nearest<30>(random.uniform(-0.7, 0.7));
    s.p[i] = nearest<18>(random.uniform(-1500, 1500));
    s.t[i] = nearest<18>(random.uniform(-1500, 1500));
  }
  return s;
}

double largest(const Eigen::Vector3d& v) { return v.cwiseAbs().maxCoeff(); }

TEST(EigenOverQ, MixedProductsRoundEveryTerm) {
  Random random;
  for (int i = 0; i < 20000; ++i) {
    const Scene s = random_scene(random);
    const Eigen::Matrix3d r = real(s.rotation);
    const Vec3Mm forward = s.rotation * s.p + s.t;
    const Vec3Mm backward = s.rotation.transpose() * (s.p - s.t);
    EXPECT_LE(largest(real(forward) - (r * real(s.p) + real(s.t))) * 0x1p18, 1.5 + 1e-6);
    EXPECT_LE(largest(real(backward) - r.transpose() * (real(s.p) - real(s.t))) * 0x1p18,
              1.5 + 1e-6);
    const Mat3Unit square = s.rotation * s.rotation.transpose();
    EXPECT_LE((real(square) - r * r.transpose()).cwiseAbs().maxCoeff() * 0x1p30, 1.5 + 1e-6);
  }
}

TEST(EigenOverQ, VectorExpressions) {
  Random random;
  for (int i = 0; i < 20000; ++i) {
    const Scene s = random_scene(random);
    const Eigen::Vector3d a = real(s.a), b = real(s.b);
    EXPECT_LE(std::abs(real(s.a.dot(s.b)) - a.dot(b)) * 0x1p30, 1.5 + 1e-6);
    EXPECT_LE(std::abs(real(s.a.squaredNorm()) - a.squaredNorm()) * 0x1p30, 1.5 + 1e-6);
    EXPECT_LE(largest(real(Vec3Unit(s.a.cross(s.b))) - a.cross(b)) * 0x1p30, 1.0 + 1e-6);
    EXPECT_LE(largest(real(Vec3Mm(s.a.cwiseProduct(s.p))) - a.cwiseProduct(real(s.p))) * 0x1p18,
              0.51);
    EXPECT_LE(largest(real(Vec3Mm(s.a * s.p[0])) - a * real(s.p[0])) * 0x1p18, 0.51);
  }
}

TEST(EigenOverQ, LargerFixedSizes) {
  Random random;
  Eigen::Matrix<Unit, 10, 6> a;
  Eigen::Matrix<Mm, 6, 10> b;
  for (int i = 0; i < 60; ++i) {
    a.data()[i] = nearest<30>(random.uniform(-1, 1));
    b.data()[i] = nearest<18>(random.uniform(-100, 100));
  }
  const Eigen::Matrix<Mm, 10, 10> product = a * b;
  EXPECT_LE((real(product) - real(a) * real(b)).cwiseAbs().maxCoeff() * 0x1p18, 3.0 + 1e-6);
}

TEST(VectorsRoundedOnce, AgainstDouble) {
  Random random;
  for (int i = 0; i < 20000; ++i) {
    const Scene s = random_scene(random);
    const Eigen::Vector3d a = real(s.a), b = real(s.b), p = real(s.p);
    EXPECT_LE(largest(real(berth::rotate(s.rotation, s.p)) - real(s.rotation) * p) * 0x1p18, 0.51);
    EXPECT_LE(std::abs(real(berth::dot<18>(s.a, s.p)) - a.dot(p)) * 0x1p18, 0.51);
    EXPECT_LE(largest(real(berth::cross<30>(s.a, s.b)) - a.cross(b)) * 0x1p30, 0.51);
    EXPECT_LE(std::abs(real(berth::norm(s.p)) - p.norm()) * 0x1p18, 0.51);
    EXPECT_LE(largest(real(berth::normalized(s.p)) - p.normalized()) * 0x1p30, 1.2);
    const Vec3Mm tiny{Mm::from_raw(random.any32() >> 24), Mm::from_raw(0), Mm::from_raw(1)};
    EXPECT_LE(largest(real(berth::normalized(tiny)) - real(tiny).normalized()) * 0x1p30, 1.2);
  }
  Unit unit[3];
  EXPECT_FALSE(berth::normalize_raw({0, 0, 0}, unit));
}

}  // namespace
}  // namespace berth_test
