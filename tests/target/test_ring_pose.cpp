// Plate poses from the exact image of a circle.
#include <gtest/gtest.h>

#include "circle/ellipse.hpp"
#include "host_sim/io/camera_model.hpp"
#include "target_scene.hpp"

namespace berth {
namespace {

// Ellipse through projected points of the ring, by a double-precision fit of its affine frame.
Ellipse image_of_ring(const host::Camera& camera, const host::Pose& pose, double radius_mm) {
  Eigen::MatrixXd a(360, 5);
  Eigen::Vector2d mean(0, 0);
  std::vector<Eigen::Vector2d> points;
  for (int k = 0; k < 360; ++k) {
    const double t = k * TargetScene::CV_PI_180;
    const Eigen::Vector3d p =
        pose.R * Eigen::Vector3d(radius_mm * std::cos(t), radius_mm * std::sin(t), 0) + pose.t;
    // Grid cells: pixels (u - 0.5) / 2.
    points.push_back((host::project(camera, p) - Eigen::Vector2d(0.5, 0.5)) / 2);
    mean += points.back() / 360;
  }
  for (int k = 0; k < 360; ++k) {
    const Eigen::Vector2d p = points[static_cast<std::size_t>(k)] - mean;
    a.row(k) << p.x() * p.x(), p.x() * p.y(), p.y() * p.y(), p.x(), p.y();
  }
  const Eigen::VectorXd c = a.colPivHouseholderQr().solve(Eigen::VectorXd::Ones(360));
  Eigen::Matrix2d m;
  m << c[0], c[1] / 2, c[1] / 2, c[2];
  const Eigen::Vector2d center = -0.5 * m.inverse() * c.tail<2>();
  const double value = 1 + center.dot(m * center);
  const Eigen::Matrix2d u = (m / value).llt().matrixU();
  Ellipse e;
  e.cx = Px::from_raw(static_cast<int>(std::lround((center.x() + mean.x()) * 65536)));
  e.cy = Px::from_raw(static_cast<int>(std::lround((center.y() + mean.y()) * 65536)));
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      e.m[i][j] = Q<26>::from_raw(static_cast<int>(std::lround(u(i, j) * (1 << 26))));
    }
  }
  return e;
}

TEST(RingPose, OneOfTheTwoPosesIsTheTruth) {
  const host::Camera camera = host::default_camera();
  const Parameters p = *host::make_parameters(camera, host::default_target());
  const SearchGrid grid{0, 0, 2, 512, 512};
  for (const double distance : {300.0, 500.0, 900.0, 1500.0}) {
    for (const double tilt : {8.0, 20.0, 40.0, 60.0}) {
      for (const double direction : {0.0, 100.0, 230.0}) {
        const double d = direction * TargetScene::CV_PI_180;
        host::Pose pose;
        pose.R = Eigen::AngleAxisd(tilt * TargetScene::CV_PI_180,
                                   Eigen::Vector3d(std::cos(d), std::sin(d), 0))
                     .toRotationMatrix();
        pose.t = Eigen::Vector3d(0.1, -0.07, 1) * distance;
        PlatePose plates[2];
        ASSERT_TRUE(solve_ring_pose(p.camera, grid, image_of_ring(camera, pose, 30),
                                    p.target.ring_outer_mm, plates));
        double best_angle = 1e9, best_shift = 1e9;
        for (const PlatePose& plate : plates) {
          Eigen::Vector3d n, c;
          for (int k = 0; k < 3; ++k) {
            n[k] = plate.basis(k, 2).raw() / double(1 << 30);
            c[k] = plate.center_mm[k].raw() / double(1 << 18);
          }
          const double angle = std::acos(std::min(1.0, n.dot(pose.R.col(2))));
          if (angle > best_angle) continue;
          best_angle = angle;
          best_shift = (c - pose.t).norm();
        }
        // What distortion across the ring and the grid of 1/64 cell leave.
        EXPECT_LT(best_angle / TargetScene::CV_PI_180, 1.5) << distance << " " << tilt;
        EXPECT_LT(best_shift, 0.01 * distance) << distance << " " << tilt;
      }
    }
  }
}

TEST(RingPose, BasisIsRightHandedAndOrthonormal) {
  const host::Camera camera = host::default_camera();
  const Parameters p = *host::make_parameters(camera, host::default_target());
  host::Pose pose;
  pose.R = Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitY()).toRotationMatrix();
  pose.t = {20, -30, 600};
  PlatePose plates[2];
  ASSERT_TRUE(solve_ring_pose(p.camera, {0, 0, 2, 512, 512}, image_of_ring(camera, pose, 30),
                              p.target.ring_outer_mm, plates));
  for (const PlatePose& plate : plates) {
    Eigen::Matrix3d b;
    for (int k = 0; k < 9; ++k) b(k / 3, k % 3) = plate.basis(k / 3, k % 3).raw() / double(1 << 30);
    EXPECT_NEAR(b.determinant(), 1, 1e-6);
    EXPECT_LT((b.transpose() * b - Eigen::Matrix3d::Identity()).norm(), 1e-6);
  }
}

}  // namespace
}  // namespace berth
