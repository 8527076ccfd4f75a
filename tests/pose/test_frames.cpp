// Frames: quaternion round trips, group laws, covariance transport against Eigen and a closed form.
#include <gtest/gtest.h>

#include <cmath>

#include "pose/frames.hpp"
#include "scenes.hpp"

namespace berth::test {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

double real(Unit u) { return std::ldexp(u.raw(), -30); }

PoseD random_transform(Envelope& envelope, double reach_mm) {
  PoseD pose;
  const Eigen::Vector4d q(envelope.normal(), envelope.normal(), envelope.normal(),
                          envelope.normal());
  pose.rotation = Eigen::Quaterniond(q).normalized().toRotationMatrix();
  for (int i = 0; i < 3; ++i) pose.translation_mm[i] = envelope.uniform(-reach_mm, reach_mm);
  return pose;
}

TEST(Frames, QuaternionIsUnitPositiveAndRight) {
  Envelope envelope(1);
  for (int n = 0; n < 2000; ++n) {
    const PoseD pose = random_transform(envelope, 1);
    const Quaternion q = quaternion_of(to_fixed(pose).rotation);
    const Eigen::Vector4d found(real(q.w), real(q.x), real(q.y), real(q.z));
    EXPECT_LT(std::abs(found.norm() - 1), std::ldexp(1, -29));
    EXPECT_GE(q.w.raw(), 0);
    const Eigen::Quaterniond expected(pose.rotation);
    const Eigen::Vector4d e(expected.w(), expected.x(), expected.y(), expected.z());
    EXPECT_LT(std::min((e - found).norm(), (e + found).norm()), 4e-9);
    RigidTransform back;
    back.rotation = rotation_of(q);
    EXPECT_LT((to_double(back).rotation - pose.rotation).norm(), 1e-8);
  }
}

TEST(Frames, QuaternionOfHalfTurnsIsUnique) {
  for (int axis = 0; axis < 3; ++axis) {
    PoseD pose;
    pose.rotation = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::Unit(axis)).toRotationMatrix();
    const Quaternion q = quaternion_of(to_fixed(pose).rotation);
    const Unit part[3] = {q.x, q.y, q.z};
    EXPECT_EQ(q.w.raw(), 0);
    EXPECT_EQ(part[axis], Unit(1));
  }
  const Quaternion one = quaternion_of(Mat3Unit::Identity());
  EXPECT_EQ(one.w, Unit(1));
}

TEST(Frames, OrthonormalizesWhatRoundingBent) {
  Envelope envelope(2);
  for (int n = 0; n < 500; ++n) {
    PoseD pose = random_transform(envelope, 1);
    const Eigen::Matrix3d clean = pose.rotation;
    for (int i = 0; i < 9; ++i) pose.rotation(i / 3, i % 3) += 1e-4 * envelope.normal();
    RigidTransform fixed = to_fixed(pose);
    fixed.rotation = orthonormalize(fixed.rotation);
    const Eigen::Matrix3d r = to_double(fixed).rotation;
    EXPECT_LT((r.transpose() * r - Eigen::Matrix3d::Identity()).norm(), 4e-9);
    EXPECT_LT((r - clean).norm(), 1e-3);
  }
}

TEST(Frames, ComposesAndInvertsAsEigenDoes) {
  Envelope envelope(3);
  for (int n = 0; n < 500; ++n) {
    const PoseD a = random_transform(envelope, 1500), b = random_transform(envelope, 1500);
    const PoseD ab = to_double(compose(to_fixed(a), to_fixed(b)));
    EXPECT_LT((ab.rotation - a.rotation * b.rotation).norm(), 1e-8);
    EXPECT_LT((ab.translation_mm - (a.rotation * b.translation_mm + a.translation_mm)).norm(),
              2e-5);
    const PoseD one = to_double(compose(to_fixed(a), inverse(to_fixed(a))));
    EXPECT_LT(rotation_error_rad(one.rotation, Eigen::Matrix3d::Identity()), 1e-8);
    EXPECT_LT(one.translation_mm.norm(), 3e-5);
  }
}

PoseCovariance to_fixed(const Matrix6& c) {
  PoseCovariance out;
  int next = 0;
  for (int i = 0; i < 6; ++i) {
    const double sigma = std::sqrt(c(i, i));
    if (i < 3) {
      out.sigma_rotation[i] = Angle::saturated(std::llround(std::ldexp(sigma, 28)));
    } else {
      out.sigma_translation_mm[i - 3] = Mm::saturated(std::llround(std::ldexp(sigma, 18)));
    }
    for (int k = i + 1; k < 6; ++k) {
      const double r = c(i, k) / (sigma * std::sqrt(c(k, k)));
      out.correlation[next++] = Unit::saturated(std::llround(std::ldexp(r, 30)));
    }
  }
  return out;
}

Matrix6 to_double(const PoseCovariance& c) {
  Matrix6 out;
  double sigma[6];
  for (int i = 0; i < 3; ++i) {
    sigma[i] = std::ldexp(c.sigma_rotation[i].raw(), -28);
    sigma[3 + i] = std::ldexp(c.sigma_translation_mm[i].raw(), -18);
  }
  int next = 0;
  for (int i = 0; i < 6; ++i) {
    out(i, i) = sigma[i] * sigma[i];
    for (int k = i + 1; k < 6; ++k) {
      out(i, k) = out(k, i) = sigma[i] * sigma[k] * real(c.correlation[next++]);
    }
  }
  return out;
}

Matrix6 random_covariance(Envelope& envelope) {
  Matrix6 a;
  for (int i = 0; i < 36; ++i) a(i / 6, i % 6) = envelope.normal();
  Matrix6 scale = Matrix6::Zero();
  scale.diagonal() << 1e-3, 1e-3, 3e-4, 0.1, 0.1, 0.3;
  return scale * (a * a.transpose() + 0.1 * Matrix6::Identity()) * scale;
}

// The covariance as the error of T_EL when each transform is disturbed: numeric derivatives.
Matrix6 disturbed(const PoseD (&chain)[3], const Matrix6 (&covariance)[3]) {
  const auto join = [](const PoseD& a, const PoseD& b) {
    PoseD ab;
    ab.rotation = a.rotation * b.rotation;
    ab.translation_mm = a.rotation * b.translation_mm + a.translation_mm;
    return ab;
  };
  const PoseD clean = join(join(chain[0], chain[1]), chain[2]);
  Matrix6 sum = Matrix6::Zero();
  for (int t = 0; t < 3; ++t) {
    Matrix6 j;
    for (int k = 0; k < 6; ++k) {
      const double h = 1e-6;
      PoseD moved[3] = {chain[0], chain[1], chain[2]};
      if (k < 3) {
        moved[t].rotation =
            Eigen::AngleAxisd(h, Eigen::Vector3d::Unit(k)).toRotationMatrix() * moved[t].rotation;
      } else {
        moved[t].translation_mm[k - 3] += h;
      }
      const PoseD end = join(join(moved[0], moved[1]), moved[2]);
      const Eigen::AngleAxisd turn(end.rotation * clean.rotation.transpose());
      j.col(k).head<3>() = turn.angle() * turn.axis() / h;
      j.col(k).tail<3>() = (end.translation_mm - clean.translation_mm) / h;
    }
    sum += j * covariance[t] * j.transpose();
  }
  return sum;
}

TEST(Frames, TransportsCovarianceAsDifferencesDo) {
  Envelope envelope(4);
  for (int n = 0; n < 100; ++n) {
    const PoseD chain[3] = {random_transform(envelope, 300), random_transform(envelope, 1500),
                            random_transform(envelope, 300)};
    const Matrix6 c[3] = {random_covariance(envelope), random_covariance(envelope),
                          random_covariance(envelope)};
    const PoseCovariance fixed[3] = {to_fixed(c[0]), to_fixed(c[1]), to_fixed(c[2])};
    const FrameChain frames{to_fixed(chain[0]), to_fixed(chain[1]), to_fixed(chain[2])};
    const Matrix6 expected = disturbed(chain, c);
    const Matrix6 found =
        to_double(transport_covariance(frames, {&fixed[0], &fixed[1], &fixed[2]}));
    for (int i = 0; i < 6; ++i) {
      for (int k = 0; k < 6; ++k) {
        EXPECT_NEAR(found(i, k), expected(i, k), 2e-3 * std::sqrt(expected(i, i) * expected(k, k)));
      }
    }
  }
}

// Rotation error sigma about y only, latch 100 mm behind the target along z: the latch moves along
// x by 100 sigma, fully correlated with the rotation.
TEST(Frames, LeverTurnsRotationIntoTranslation) {
  FrameChain frames;
  frames.camera_from_target.translation_mm = {Mm(0), Mm(0), Mm(500)};
  frames.target_from_latch.translation_mm = {Mm(0), Mm(0), Mm(100)};
  PoseCovariance covariance;
  covariance.sigma_rotation[1] = q<28>(1e-3);
  const PoseCovariance moved = transport_covariance(frames, {nullptr, &covariance, nullptr});
  EXPECT_NEAR(std::ldexp(moved.sigma_rotation[1].raw(), -28), 1e-3, 1e-8);
  EXPECT_NEAR(std::ldexp(moved.sigma_translation_mm[0].raw(), -18), 0.1, 1e-5);
  EXPECT_EQ(moved.sigma_translation_mm[1].raw(), 0);
  EXPECT_EQ(moved.sigma_translation_mm[2].raw(), 0);
  EXPECT_NEAR(real(moved.correlation[5 + 1]), 1, 1e-5);  // ry with tx
  EXPECT_NEAR(std::ldexp(effector_from_latch(frames).translation_mm[2].raw(), -18), 600, 1e-5);
}

}  // namespace
}  // namespace berth::test
