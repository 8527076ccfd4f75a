// The ellipse fit against ellipses that are known, and against OpenCV's.
#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "circle/ellipse.hpp"

namespace berth {
namespace {

struct TrueEllipse {
  double cx, cy, a, b, angle;
  cv::Point2d at(double t) const {
    const double x = a * std::cos(t), y = b * std::sin(t);
    return {cx + x * std::cos(angle) - y * std::sin(angle),
            cy + x * std::sin(angle) + y * std::cos(angle)};
  }
};

double px(Px v) { return v.raw() / 65536.0; }

// Three fits in the frame of the one before, as the ring search does it.
bool fit(const std::vector<cv::Point2d>& points, Ellipse& e) {
  for (int round = 0; round < 3; ++round) {
    const EllipseFrame frame(e);
    EllipseFit sums;
    for (const cv::Point2d& p : points) {
      const FramePoint q = frame.map(static_cast<int>(std::lround(p.x * 64)),
                                     static_cast<int>(std::lround(p.y * 64)));
      if (std::abs(q.x) < 8000 && std::abs(q.y) < 8000) sums.add(q);
    }
    if (!sums.solve(frame, e)) return false;
  }
  return true;
}

const TrueEllipse kCases[] = {{200.3, 150.7, 60, 55, 0.3},
                              {100.1, 90.2, 12.5, 9.6, 1.2},
                              {250.0, 260.5, 62.4, 31.2, -0.7},
                              {300.6, 200.4, 150, 115, 2.0}};

TEST(EllipseFit, RecoversEllipsesFromTwoThirdsOfTheirOutline) {
  for (const TrueEllipse& truth : kCases) {
    std::vector<cv::Point2d> points;
    for (double t = 0; t < 4.2; t += 0.03) points.push_back(truth.at(t));
    Ellipse e = Ellipse::circle(Px::from_raw(static_cast<int>((truth.cx + 2) * 65536)),
                                Px::from_raw(static_cast<int>((truth.cy - 2) * 65536)),
                                Px::from_raw(static_cast<int>(truth.a * 0.95 * 65536)));
    ASSERT_TRUE(fit(points, e));
    EllipseAxes axes;
    ASSERT_TRUE(measure_axes(e, Px(1000), axes));
    EXPECT_NEAR(px(e.cx), truth.cx, 0.03);
    EXPECT_NEAR(px(e.cy), truth.cy, 0.03);
    EXPECT_NEAR(px(axes.major), truth.a, 0.03);
    EXPECT_NEAR(px(axes.minor), truth.b, 0.03);
  }
}

TEST(EllipseFit, IsNoWorseThanOpenCvUnderNoise) {
  cv::RNG rng(3);
  double ours = 0, theirs = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const TrueEllipse truth = kCases[trial % 4];
    std::vector<cv::Point2d> points;
    std::vector<cv::Point2f> floats;
    for (double t = 0; t < 4.7; t += 0.05) {
      cv::Point2d p = truth.at(t);
      p.x += rng.gaussian(0.15);
      p.y += rng.gaussian(0.15);
      points.push_back(p);
      floats.emplace_back(static_cast<float>(p.x), static_cast<float>(p.y));
    }
    Ellipse e = Ellipse::circle(Px::from_raw(static_cast<int>(truth.cx * 65536)),
                                Px::from_raw(static_cast<int>(truth.cy * 65536)),
                                Px::from_raw(static_cast<int>(truth.a * 65536)));
    ASSERT_TRUE(fit(points, e));
    const cv::RotatedRect r = cv::fitEllipseDirect(floats);
    ours += std::pow(px(e.cx) - truth.cx, 2) + std::pow(px(e.cy) - truth.cy, 2);
    theirs += std::pow(r.center.x - truth.cx, 2) + std::pow(r.center.y - truth.cy, 2);
  }
  EXPECT_LT(std::sqrt(ours), 1.1 * std::sqrt(theirs));
}

TEST(EllipseFit, PointsOnALineAreNoEllipse) {
  std::vector<cv::Point2d> points;
  for (int k = 0; k < 40; ++k) points.push_back({100.0 + k, 100.0});
  Ellipse e = Ellipse::circle(Px(120), Px(110), Px(20));
  EXPECT_FALSE(fit(points, e));
}

TEST(Ellipse, PointsLieOnTheUnitCircleOfItsFrame) {
  Ellipse e = Ellipse::circle(Px(100), Px(80), Px(40));
  e.m[0][1] = q<26>(0.01);
  const EllipseFrame frame(e);
  for (double t = 0; t < 6.2; t += 0.1) {
    const EllipsePoint p =
        point_at(e, Unit::saturated(static_cast<std::int64_t>(std::cos(t) * (1 << 30))),
                 Unit::saturated(static_cast<std::int64_t>(std::sin(t) * (1 << 30))));
    const FramePoint f = frame.map(p.x.to<6>().raw(), p.y.to<6>().raw());
    EXPECT_NEAR(std::hypot(f.x, f.y) / 4096, 1, 2e-3);
  }
}

}  // namespace
}  // namespace berth
