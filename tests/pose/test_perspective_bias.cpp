// Predicted centroids against the area centroid of the dense outline, derivatives against
// differences of it.
#include <gtest/gtest.h>

#include <cmath>

#include "pose/perspective_bias.hpp"
#include "scenes.hpp"

namespace berth::test {
namespace {

Eigen::Vector2d real(const Vec2Px& p) { return {p[0].raw() / 65536.0, p[1].raw() / 65536.0}; }

struct Worst {
  double dot = 0, ring = 0, line = 0, rough_dot = 0;
};

Worst sweep(const CameraD& camera, double distance_mm, double tilt_deg) {
  const Camera fixed_camera = to_fixed(camera);
  const TargetModel target = ct1();
  Envelope envelope(1);
  Worst worst;
  for (int n = 0; n < 60; ++n) {
    const PoseD pose = envelope.draw_at(camera, distance_mm, tilt_deg * M_PI / 180);
    const auto error = [&](MarkerKind kind, int index) {
      PredictedCentroid predicted;
      const MarkerNodes nodes = nodes_of(target, kind, index);
      EXPECT_TRUE(predict_centroid(fixed_camera, to_fixed(pose), nodes, predicted));
      const Eigen::Vector2d truth = area_centroid(camera, pose, target, kind, index);
      if (kind == MarkerKind::kDot) {
        Vec2Px rough;
        EXPECT_TRUE(predict_centroid_roughly(fixed_camera, to_fixed(pose), nodes, rough));
        worst.rough_dot = std::max(worst.rough_dot, (real(rough) - truth).norm());
      }
      return (real(predicted.centroid_px) - truth).norm();
    };
    for (int i = 0; i < target.dot_count; ++i) {
      worst.dot = std::max(worst.dot, error(MarkerKind::kDot, i));
    }
    worst.ring = std::max(worst.ring, error(MarkerKind::kRing, 0));
    worst.line = std::max(worst.line, error(MarkerKind::kLine, 0));
  }
  return worst;
}

TEST(PerspectiveBias, IsWithinAFewTenThousandthsOfAPixelForDots) {
  for (const CameraD& camera : {ideal_camera(), hec1_camera()}) {
    const Worst near = sweep(camera, 300, 40);
    EXPECT_LT(near.dot, 0.0005);
    EXPECT_LT(near.line, 0.0005);
    EXPECT_LT(near.ring, 0.006);
    EXPECT_LT(near.rough_dot, 0.1);
    const Worst far = sweep(camera, 1000, 40);
    EXPECT_LT(far.dot, 0.0001);
    EXPECT_LT(far.line, 0.0001);
    EXPECT_LT(far.ring, 0.0002);
  }
}

TEST(PerspectiveBias, FailsBehindTheCamera) {
  PoseD pose;
  pose.translation_mm = {0, 0, -300};
  PredictedCentroid predicted;
  EXPECT_FALSE(predict_centroid(to_fixed(ideal_camera()), to_fixed(pose),
                                nodes_of(ct1(), MarkerKind::kDot, 1), predicted));
}

TEST(PerspectiveBias, DerivativesMatchDifferences) {
  const CameraD camera = hec1_camera();
  const TargetModel target = ct1();
  Envelope envelope(9);
  for (int n = 0; n < 20; ++n) {
    const PoseD pose = envelope.draw(camera);
    for (const int index : {0, 2}) {
      PredictedCentroid predicted;
      ASSERT_TRUE(predict_centroid(to_fixed(camera), to_fixed(pose),
                                   nodes_of(target, MarkerKind::kDot, index), predicted));
      Eigen::Matrix<double, 2, 6> expected, found;
      for (int k = 0; k < 6; ++k) {
        const double h = k < 3 ? 1e-4 : 1e-2;
        const auto moved = [&](double by) {
          PoseD p = pose;
          if (k < 3) {
            p.rotation =
                Eigen::AngleAxisd(by, Eigen::Vector3d::Unit(k)).toRotationMatrix() * p.rotation;
          } else {
            p.translation_mm[k - 3] += by;
          }
          return area_centroid(camera, p, target, MarkerKind::kDot, index);
        };
        expected.col(k) = (moved(h) - moved(-h)) / (2 * h);
        const double unit = k < 3 ? 4096.0 : 4096.0 * 256;
        for (int i = 0; i < 2; ++i) found(i, k) = predicted.by_pose.row[i][k] / unit;
      }
      EXPECT_LT((found - expected).leftCols(3).norm(), 0.01 * expected.leftCols(3).norm());
      EXPECT_LT((found - expected).rightCols(3).norm(), 0.01 * expected.rightCols(3).norm());
    }
  }
}

}  // namespace
}  // namespace berth::test
