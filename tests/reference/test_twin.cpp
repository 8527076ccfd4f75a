// The double twin of the pose stages: closed forms, exact data, covariance against Monte Carlo.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <opencv2/imgproc.hpp>
#include <random>

#include "host_sim/reference/circle_pose.hpp"
#include "host_sim/reference/marker_model.hpp"
#include "scenes.hpp"

namespace berth::test {
namespace {

using namespace berth::host;

Rigid rigid_of(const Pose& pose) { return {pose.R, pose.t}; }

Camera without_distortion() {
  Camera camera = default_camera();
  camera.k1 = camera.k2 = camera.p1 = camera.p2 = 0;
  return camera;
}

TEST(Rotation, LogIsTheInverseOfExp) {
  for (const double angle : {1e-12, 1e-6, 0.3, 2.0, 3.1415}) {
    const Eigen::Vector3d v = angle * Eigen::Vector3d(0.6, -0.64, 0.48);
    EXPECT_LT((rotation_log(rotation_exp(v)) - v).norm(), 1e-12 * (1 + angle));
  }
  EXPECT_EQ(rotation_log(Eigen::Matrix3d::Identity()).norm(), 0);
}

TEST(MarkerModel, PolygonCentroidOfARectangleOffTheOrigin) {
  const AreaCentroid c = polygon_centroid({{1000, 500}, {1004, 500}, {1004, 502}, {1000, 502}});
  EXPECT_DOUBLE_EQ(c.center.x(), 1002);
  EXPECT_DOUBLE_EQ(c.center.y(), 501);
  EXPECT_DOUBLE_EQ(c.area, 8);
}

TEST(MarkerModel, ConicCenterIsTheCenterOfTheProjectedOutline) {
  const Camera camera = without_distortion();
  const Rigid pose = rigid_of(pose_at(300, 40, 25));
  const Circle ring{Eigen::Vector3d::Zero(), 30};
  const auto outline = project_points(camera, pose, circle_outline(ring.center_mm, 30, 512));
  // Without distortion the outline is an ellipse, whose centre is also its area centroid.
  const Eigen::Vector2d centroid = polygon_centroid(outline).center;
  EXPECT_LT((conic_center(camera, pose, ring) - centroid).norm(), 1e-3);
  // The specification's perspective bias: about 6 px for the ring here.
  EXPECT_NEAR((centroid - project_ideal(camera, pose, ring.center_mm)).norm(), 6, 1);
}

TEST(CirclePose, OneOfTheTwoIsTheTruth) {
  const Camera camera = without_distortion();
  for (const double tilt_deg : {2.0, 15.0, 40.0}) {
    const Rigid pose = rigid_of(pose_at(500, tilt_deg, 70));
    const auto outline = project_points(camera, pose, circle_outline({0, 0, 0}, 30, 200));
    const std::vector<cv::Point2f> points(outline.begin(), outline.end());
    double best = 1e9;
    for (const CirclePose& c : circle_poses(camera, cv::fitEllipse(points), 30)) {
      best =
          std::min(best, (c.normal - pose.R.col(2)).norm() + (c.center_mm - pose.t).norm() / 500);
    }
    EXPECT_LT(best, 0.01) << tilt_deg;
  }
}

TEST(SolveP3p, OneSolutionIsTheTruth) {
  const std::vector<Eigen::Vector3d> points = {{0, 0, -20}, {-45, -45, 0}, {45, 45, 0}};
  for (const double tilt_deg : {0.0, 10.0, 25.0, 40.0}) {
    const Rigid pose = rigid_of(pose_at(700, tilt_deg, -130));
    std::vector<Eigen::Vector2d> rays;
    for (const Eigen::Vector3d& p : points) {
      const Eigen::Vector3d c = pose.R * p + pose.t;
      rays.emplace_back(c.x() / c.z(), c.y() / c.z());
    }
    double best_deg = 180;
    for (const Rigid& solution : solve_p3p(points, rays)) {
      best_deg = std::min(best_deg, rotation_log(solution.R * pose.R.transpose()).norm() * 57.3);
    }
    EXPECT_LT(best_deg, 1e-4) << tilt_deg;
  }
}

std::vector<Observation> exact_observations(const Rigid& pose) {
  auto observations = centroid_observations(default_camera(), default_target());
  for (Observation& o : observations) o.center_px = o.predict(pose);
  return observations;
}

TEST(RefinePose, ReturnsToTheTruthFromFarOff) {
  const Rigid truth = rigid_of(pose_at(600, 30, 25));
  const Rigid start{rotation_exp({0.15, -0.1, 0.2}) * truth.R, truth.t * 1.1};
  const RefinedPose refined = refine_pose(exact_observations(truth), start);
  EXPECT_TRUE(refined.has_converged);
  EXPECT_LT(rotation_log(refined.camera_from_target.R * truth.R.transpose()).norm(), 1e-9);
  EXPECT_LT((refined.camera_from_target.t - truth.t).norm(), 1e-6);
  EXPECT_LT(refined.rms_px, 1e-8);
}

TEST(RefinePose, CovarianceIsThatOfTheErrors) {
  constexpr int kDraws = 400;
  constexpr double kNoise_px = 0.05;
  const Rigid truth = rigid_of(pose_at(500, 20, 25));
  const auto exact = exact_observations(truth);
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, kNoise_px);
  double nees = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    auto observations = exact;
    for (Observation& o : observations) {
      o.center_px += Eigen::Vector2d(noise(random), noise(random));
      o.covariance_px2 = Eigen::Matrix2d::Identity() * kNoise_px * kNoise_px;
    }
    const RefinedPose refined = refine_pose(observations, truth);
    Vector6d error;
    error << rotation_log(refined.camera_from_target.R * truth.R.transpose()),
        refined.camera_from_target.t - truth.t;
    nees += error.dot(refined.covariance.inverse() * error) / 6 / kDraws;
  }
  // The mean of 400 draws of chi squared with 6 degrees of freedom scatters by 0.03.
  EXPECT_NEAR(nees, 1, 0.1);
}

TEST(ComparePoses, CountsCombinedSigmasPerAxis) {
  PoseWithSigmas a{rigid_of(pose_at(500, 20, 0)), {3e-4, 3e-4, 3e-4, 0.03, 0.03, 0.03}};
  PoseWithSigmas b = a;
  b.sigmas = {4e-4, 4e-4, 4e-4, 0.04, 0.04, 0.04};
  EXPECT_EQ(compare_poses(a, b).largest, 0);
  a.camera_from_target.R = rotation_exp({0, 1e-3, 0}) * b.camera_from_target.R;
  a.camera_from_target.t.z() += 0.2;
  const PoseDifference d = compare_poses(a, b);
  EXPECT_NEAR(d.combined_sigmas[1], 2, 1e-6);
  EXPECT_NEAR(d.combined_sigmas[5], 4, 1e-6);
  EXPECT_NEAR(d.combined_sigmas[0], 0, 1e-6);
  EXPECT_DOUBLE_EQ(d.largest, d.combined_sigmas[5]);
  EXPECT_NEAR(d.deltas[5], 0.2, 1e-12);
}

}  // namespace
}  // namespace berth::test
