// Cameras of the projection tests, and OpenCV's view of them.
#pragma once

#include "camera/projection.hpp"
#include "reference.hpp"
// After fixed/eigen.hpp, which sets Eigen up.
#include <opencv2/calib3d.hpp>
#include <vector>

namespace berth_test {

inline berth::Camera make_camera(double focal, double k1, double k2, double p1, double p2,
                                 double k3) {
  berth::Camera camera;
  camera.width = camera.height = 1024;
  camera.fx = nearest<16>(focal);
  camera.fy = nearest<16>(focal * 1.01);
  camera.cx = nearest<16>(515.3);
  camera.cy = nearest<16>(508.7);
  camera.k1 = nearest<24>(k1);
  camera.k2 = nearest<24>(k2);
  camera.p1 = nearest<24>(p1);
  camera.p2 = nearest<24>(p2);
  camera.k3 = nearest<24>(k3);
  return camera;
}

struct NamedCamera {
  const char* name;
  berth::Camera camera;
};

/// HEC-1 and cameras from a fisheye-like wide angle to a long lens.
inline std::vector<NamedCamera> valid_cameras() {
  return {
      {"hec1", make_camera(1250, -0.12, 0.08, 0.0002, -0.0003, 0)},
      {"undistorted", make_camera(1250, 0, 0, 0, 0, 0)},
      {"wide", make_camera(480, -0.12, 0.015, 0.001, -0.001, -0.0005)},
      {"pincushion", make_camera(800, 0.25, 0.1, -0.002, 0.001, 0.05)},
      {"long", make_camera(4000, 5, -60, 0.003, 0.003, 100)},
  };
}

/// The same camera for OpenCV, from the quantised values.
struct CvCamera {
  explicit CvCamera(const berth::Camera& c)
      : matrix(real(c.fx), 0, real(c.cx), 0, real(c.fy), real(c.cy), 0, 0, 1),
        distortion(real(c.k1), real(c.k2), real(c.p1), real(c.p2), real(c.k3)) {}

  /// Projection of a point; by_point, if given, is filled with d(u, v) / d(X, Y, Z).
  cv::Point2d project(const cv::Point3d& point, cv::Matx23d* by_point = nullptr) const {
    std::vector<cv::Point2d> pixels;
    cv::Mat jacobian;
    const cv::Vec3d zero(0, 0, 0);
    cv::projectPoints(std::vector<cv::Point3d>{point}, zero, zero, matrix, distortion, pixels,
                      jacobian);
    if (by_point != nullptr) {
      for (int i = 0; i < 2; ++i) {
        for (int k = 0; k < 3; ++k) (*by_point)(i, k) = jacobian.at<double>(i, 3 + k);
      }
    }
    return pixels[0];
  }

  cv::Matx33d matrix;
  cv::Vec<double, 5> distortion;
};

}  // namespace berth_test
