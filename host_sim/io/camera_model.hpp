// The pinhole camera with Brown-Conrady distortion, in double precision.
//
//   x' = x/z, y' = y/z, r^2 = x'^2 + y'^2, s = 1 + k1 r^2 + k2 r^4 + k3 r^6
//   x" = x' s + 2 p1 x' y' + p2 (r^2 + 2 x'^2),   y" = y' s + p1 (r^2 + 2 y'^2) + 2 p2 x' y'
//   u = fx x" + cx, v = fy y" + cy; the centre of the top-left pixel is (0, 0) (OpenCV's
//   convention).
//
// Only + - * / and sqrt are used, so that results are the same on every machine.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

namespace berth::host {

/// A camera as its calibration file describes it; focal lengths and principal point in pixels.
struct Camera {
  std::string name;
  int width = 0;
  int height = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;
};

/// Normalised image coordinates (x/z, y/z) with lens distortion applied.
Eigen::Vector2d distort(const Camera& camera, const Eigen::Vector2d& normalised);

/// Determinant of the distortion's Jacobian; positive where the distortion can be inverted.
double distortion_determinant(const Camera& camera, const Eigen::Vector2d& normalised);

/// Pixel of a point in the camera frame (mm, z > 0).
Eigen::Vector2d project(const Camera& camera, const Eigen::Vector3d& p_camera_mm);

/// Normalised coordinates whose distorted pixel is the given one: Newton to rounding error.
/// Nothing where it does not converge, which does not happen inside an accepted camera's image.
std::optional<Eigen::Vector2d> undistort(const Camera& camera, const Eigen::Vector2d& pixel);

/// Whether the distortion is one-to-one on the whole image, its corners' outer edges included.
bool is_invertible(const Camera& camera);

/// The camera of images binned by `factor` x `factor`: binned pixel (i, j) has its centre at
/// (f i + (f - 1) / 2, f j + (f - 1) / 2). Rows and columns that do not fill a bin are dropped.
Camera binned(const Camera& camera, int factor);

}  // namespace berth::host
