// What counts: errors against closed forms, OpenCV's Rodrigues and projectPoints, and Eigen.
#include "host_sim/report/evaluate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/calib3d.hpp>
#include <random>

#include "host_sim/io/camera_file.hpp"

namespace berth::host {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

DoublePose pose_at(double distance_mm, double roll_deg, double tilt_deg_) {
  DoublePose pose;
  pose.translation_mm = distance_mm * Eigen::Vector3d(0.02, -0.03, 1).normalized();
  pose.rotation = Eigen::AngleAxisd(roll_deg * kDegree, Eigen::Vector3d::UnitZ()) *
                  Eigen::AngleAxisd(tilt_deg_ * kDegree, Eigen::Vector3d::UnitX());
  return pose;
}

WireTransform to_wire(const DoublePose& pose) {
  WireTransform wire;
  const Eigen::Quaterniond q =
      pose.rotation.w() < 0 ? Eigen::Quaterniond(-pose.rotation.coeffs()) : pose.rotation;
  for (int i = 0; i < 3; ++i) {
    wire.translation_mm[i] =
        Mm::from_raw(static_cast<int>(std::lround(pose.translation_mm[i] * (1 << 18))));
  }
  const auto unit = [](double v) {
    return Unit::from_raw(static_cast<int>(std::lround(v * (1 << 30))));
  };
  wire.rotation = {unit(q.w()), unit(q.x()), unit(q.y()), unit(q.z())};
  return wire;
}

TruthRow truth_of(const DoublePose& pose) {
  TruthRow row;
  row.pose = pose;
  return row;
}

/// A valid record whose pose is off by an angle about z and a shift along z.
FrameRecord record_off_by(const DoublePose& truth, double angle_deg, double shift_mm) {
  DoublePose estimate = truth;
  estimate.rotation =
      Eigen::AngleAxisd(angle_deg * kDegree, Eigen::Vector3d::UnitZ()) * truth.rotation;
  estimate.translation_mm.z() += shift_mm;
  FrameRecord record;
  record.pose.valid = record.pose.identified = record.pose.has_pose = true;
  record.pose.reason = Reason::kNone;
  record.pose.camera_from_target = to_wire(estimate);
  const RingView ring = ring_view(default_camera(), default_target(), truth);
  for (int i = 0; i < 2; ++i) {
    record.algorithm.ring_center_px[i] =
        Px::from_raw(static_cast<int>(std::lround(ring.center_px[i] * 65536)));
  }
  record.algorithm.roll = Angle::from_raw(static_cast<int>(std::lround(ring.roll_rad * (1 << 28))));
  return record;
}

Verdict judged(const FrameRecord& record, const DoublePose& truth) {
  return judge(record, truth_of(truth), default_camera(), default_target());
}

TEST(Evaluate, RotationErrorIsTheAngleBetween) {
  const DoublePose a = pose_at(500, 25, 30);
  for (const double angle : {0.0, 1e-5, 0.01, 90.0, 179.9}) {
    DoublePose b = a;
    b.rotation =
        Eigen::AngleAxisd(angle * kDegree, Eigen::Vector3d(1, 2, -1).normalized()) * a.rotation;
    EXPECT_NEAR(rotation_error_deg(b, a), angle, 1e-9 + 1e-12 * angle);
    b.rotation.coeffs() = -b.rotation.coeffs();  // the same rotation
    EXPECT_NEAR(rotation_error_deg(b, a), angle, 1e-9 + 1e-12 * angle);
  }
}

TEST(Evaluate, TiltIsBetweenNormalAndDirectionToTheCamera) {
  DoublePose pose;
  pose.translation_mm = {0, 0, 400};
  EXPECT_NEAR(tilt_deg(pose), 0, 1e-9);
  pose.rotation = Eigen::AngleAxisd(30 * kDegree, Eigen::Vector3d::UnitY());
  EXPECT_NEAR(tilt_deg(pose), 30, 1e-9);
  pose.rotation = Eigen::Quaterniond::Identity();
  pose.translation_mm = {400, 0, 400};  // seen from 45 degrees beside the normal
  EXPECT_NEAR(tilt_deg(pose), 45, 1e-9);
}

TEST(Evaluate, HighPrecisionGrowsWithTheSquareOfTheDistance) {
  for (const double distance : {300.0, 600.0, 1500.0}) {
    const DoublePose truth = pose_at(distance, 10, 20);
    const double scale = distance * distance / 90000;
    EXPECT_TRUE(judged(record_off_by(truth, 0.0149 * scale, 0.199 * scale), truth).high_precision);
    EXPECT_FALSE(judged(record_off_by(truth, 0.0151 * scale, 0), truth).high_precision);
    EXPECT_FALSE(judged(record_off_by(truth, 0, 0.201 * scale), truth).high_precision);
  }
}

TEST(Evaluate, PoseThatIsNotValidIsNeitherPreciseNorFalse) {
  const DoublePose truth = pose_at(500, 10, 20);
  FrameRecord record = record_off_by(truth, 0, 0);
  record.pose.valid = false;
  EXPECT_FALSE(judged(record, truth).high_precision);
  record = record_off_by(truth, 10, 100);
  record.pose.valid = false;
  EXPECT_FALSE(judged(record, truth).false_pose);
}

TEST(Evaluate, FalsePoseBeyondTwoDegreesOrTwoPerCent) {
  const DoublePose truth = pose_at(500, 10, 20);
  EXPECT_FALSE(judged(record_off_by(truth, 1.99, 9.9), truth).false_pose);
  EXPECT_TRUE(judged(record_off_by(truth, 2.01, 0), truth).false_pose);
  EXPECT_TRUE(judged(record_off_by(truth, 0, 10.1), truth).false_pose);
}

TEST(Evaluate, WithoutATargetEveryAcceptanceIsFalse) {
  FrameRecord record;
  record.pose.identified = true;
  Verdict verdict = judge(record, TruthRow{}, default_camera(), default_target());
  EXPECT_TRUE(verdict.false_identification);
  EXPECT_FALSE(verdict.false_pose);
  record.pose.valid = true;
  EXPECT_TRUE(judge(record, TruthRow{}, default_camera(), default_target()).false_pose);
}

TEST(Evaluate, IdentifiedWithinFivePerCentAndFiveDegrees) {
  const DoublePose truth = pose_at(500, 120, 35);
  const RingView ring = ring_view(default_camera(), default_target(), truth);
  FrameRecord record = record_off_by(truth, 0, 0);
  EXPECT_TRUE(judged(record, truth).identified);
  const Px x = record.algorithm.ring_center_px[0];
  record.algorithm.ring_center_px[0] =
      Px::from_raw(x.raw() + static_cast<int>(0.051 * ring.radius_px * 65536));
  EXPECT_FALSE(judged(record, truth).identified);
  EXPECT_TRUE(judged(record, truth).false_identification);
  record.algorithm.ring_center_px[0] = x;
  record.algorithm.roll = record.algorithm.roll + q<28>(5.1 * kDegree);
  EXPECT_FALSE(judged(record, truth).identified);
  record.algorithm.roll = record.algorithm.roll - q<28>(5.2 * kDegree) - q<28>(6.283185307179586);
  EXPECT_TRUE(judged(record, truth).identified);  // a full turn is no difference
}

TEST(Evaluate, RingViewAgreesWithProjectPoints) {
  const Camera camera = default_camera();
  const DoublePose pose = pose_at(300, 25, 40);
  const cv::Matx33d k(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  const cv::Vec<double, 5> d(camera.k1, camera.k2, camera.p1, camera.p2, camera.k3);
  const Eigen::AngleAxisd turn(pose.rotation);
  const Eigen::Vector3d r = turn.axis() * turn.angle();
  std::vector<cv::Point3d> outline;
  for (int i = 0; i < 3600; ++i) {
    const double a = i * 0.1 * kDegree;
    outline.emplace_back(30 * std::cos(a), 30 * std::sin(a), 0);
  }
  outline.emplace_back(0, 0, 0);
  std::vector<cv::Point2d> image;
  const Eigen::Vector3d& t = pose.translation_mm;
  cv::projectPoints(outline, cv::Vec3d(r.x(), r.y(), r.z()), cv::Vec3d(t.x(), t.y(), t.z()), k, d,
                    image);
  const cv::Point2d center = image.back();
  image.pop_back();
  double longest = 0;
  for (int i = 0; i < 1800; ++i) longest = std::max(longest, cv::norm(image[i + 1800] - image[i]));
  const RingView ring = ring_view(camera, default_target(), pose);
  EXPECT_NEAR(ring.center_px.x(), center.x, 1e-6);
  EXPECT_NEAR(ring.center_px.y(), center.y, 1e-6);
  EXPECT_NEAR(ring.radius_px, longest / 2, 0.01 * ring.radius_px);
}

TEST(Evaluate, NormalisedErrorsOfDrawnPosesAverageSix) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  Eigen::Matrix<double, 6, 6> factor = Eigen::Matrix<double, 6, 6>::Zero();
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j <= i; ++j) factor(i, j) = (i == j ? 1.0 : 0.4 * normal(random));
  }
  const Eigen::Matrix<double, 6, 1> scale =
      (Eigen::Matrix<double, 6, 1>() << 1e-5, 2e-5, 1e-6, 0.01, 0.02, 0.1).finished();
  factor = scale.asDiagonal() * factor;
  const Eigen::Matrix<double, 6, 6> covariance = factor * factor.transpose();
  const DoublePose truth = pose_at(700, 40, 15);
  double sum = 0;
  constexpr int kDraws = 4000;
  for (int n = 0; n < kDraws; ++n) {
    Eigen::Matrix<double, 6, 1> white;
    for (int i = 0; i < 6; ++i) white[i] = normal(random);
    const Eigen::Matrix<double, 6, 1> error = factor * white;
    DoublePose estimate = truth;
    const Eigen::Vector3d delta = error.head<3>();
    estimate.rotation = Eigen::AngleAxisd(delta.norm(), delta.normalized()) * truth.rotation;
    estimate.translation_mm += error.tail<3>();
    sum += normalised_error_squared(estimate, truth, covariance).value();
  }
  EXPECT_NEAR(sum / kDraws, 6, 4 * std::sqrt(12.0 / kDraws));  // chi squared with 6 degrees
}

TEST(Evaluate, CovarianceThatIsNoneGivesNoNormalisedError) {
  const DoublePose pose = pose_at(500, 0, 0);
  EXPECT_FALSE(normalised_error_squared(pose, pose, Eigen::Matrix<double, 6, 6>::Zero()));
}

}  // namespace
}  // namespace berth::host
