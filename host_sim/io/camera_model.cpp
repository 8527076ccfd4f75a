#include "host_sim/io/camera_model.hpp"

#include <cmath>

namespace berth::host {
namespace {

struct Jacobian {
  double xx, xy, yx, yy;
  double determinant() const { return xx * yy - xy * yx; }
};

Jacobian distortion_jacobian(const Camera& c, double x, double y) {
  const double r2 = x * x + y * y;
  const double s = 1.0 + r2 * (c.k1 + r2 * (c.k2 + r2 * c.k3));
  const double ds = c.k1 + r2 * (2.0 * c.k2 + r2 * 3.0 * c.k3);  // ds / d(r^2)
  const double cross = 2.0 * x * y * ds + 2.0 * c.p1 * x + 2.0 * c.p2 * y;
  return {s + 2.0 * x * x * ds + 2.0 * c.p1 * y + 6.0 * c.p2 * x, cross, cross,
          s + 2.0 * y * y * ds + 6.0 * c.p1 * y + 2.0 * c.p2 * x};
}

bool is_inside_image(const Camera& c, const Eigen::Vector2d& distorted) {
  const double u = c.fx * distorted.x() + c.cx;
  const double v = c.fy * distorted.y() + c.cy;
  return u >= -0.5 && v >= -0.5 && u <= c.width - 0.5 && v <= c.height - 0.5;
}

// Follows a ray outwards until its image leaves the frame; the determinant must stay positive.
bool is_invertible_along(const Camera& camera, double dx, double dy) {
  constexpr double kStep = 0.005;
  constexpr double kLargestRadius = 10.0;  // 84 degrees off the axis
  for (double r = 0.0; r <= kLargestRadius; r += kStep) {
    const Eigen::Vector2d p(r * dx, r * dy);
    if (distortion_determinant(camera, p) <= 0.0) return false;
    if (!is_inside_image(camera, distort(camera, p))) return true;
  }
  return false;
}

}  // namespace

Eigen::Vector2d distort(const Camera& c, const Eigen::Vector2d& normalised) {
  const double x = normalised.x();
  const double y = normalised.y();
  const double r2 = x * x + y * y;
  const double s = 1.0 + r2 * (c.k1 + r2 * (c.k2 + r2 * c.k3));
  return {x * s + 2.0 * c.p1 * x * y + c.p2 * (r2 + 2.0 * x * x),
          y * s + c.p1 * (r2 + 2.0 * y * y) + 2.0 * c.p2 * x * y};
}

double distortion_determinant(const Camera& camera, const Eigen::Vector2d& normalised) {
  return distortion_jacobian(camera, normalised.x(), normalised.y()).determinant();
}

Eigen::Vector2d project(const Camera& camera, const Eigen::Vector3d& p_camera_mm) {
  const double x = p_camera_mm.x() / p_camera_mm.z();
  const double y = p_camera_mm.y() / p_camera_mm.z();
  const Eigen::Vector2d d = distort(camera, {x, y});
  return {camera.fx * d.x() + camera.cx, camera.fy * d.y() + camera.cy};
}

std::optional<Eigen::Vector2d> undistort(const Camera& camera, const Eigen::Vector2d& pixel) {
  constexpr int kIterations = 30;
  constexpr double kTolerance = 1e-13;
  const double target_x = (pixel.x() - camera.cx) / camera.fx;
  const double target_y = (pixel.y() - camera.cy) / camera.fy;
  double x = target_x;
  double y = target_y;
  for (int i = 0; i < kIterations; ++i) {
    const Eigen::Vector2d d = distort(camera, {x, y});
    const double ex = target_x - d.x();
    const double ey = target_y - d.y();
    if (ex * ex + ey * ey <= kTolerance * kTolerance) return Eigen::Vector2d(x, y);
    const Jacobian j = distortion_jacobian(camera, x, y);
    const double det = j.determinant();
    if (!(det > 0.0)) return std::nullopt;
    x += (j.yy * ex - j.xy * ey) / det;
    y += (j.xx * ey - j.yx * ex) / det;
  }
  return std::nullopt;
}

bool is_invertible(const Camera& camera) {
  // Directions through points of the border rather than equal angles: the corners are included.
  constexpr int kPerSide = 64;
  for (int i = 0; i <= kPerSide; ++i) {
    const double u = camera.width * static_cast<double>(i) / kPerSide - 0.5;
    const double v = camera.height * static_cast<double>(i) / kPerSide - 0.5;
    const double border[4][2] = {
        {u, -0.5}, {u, camera.height - 0.5}, {-0.5, v}, {camera.width - 0.5, v}};
    for (const auto& p : border) {
      const double dx = (p[0] - camera.cx) / camera.fx;
      const double dy = (p[1] - camera.cy) / camera.fy;
      const double length = std::sqrt(dx * dx + dy * dy);
      if (!(length > 0.0) || !is_invertible_along(camera, dx / length, dy / length)) return false;
    }
  }
  return true;
}

Camera binned(const Camera& camera, int factor) {
  const double offset = (factor - 1) / 2.0;
  Camera result = camera;
  result.width = camera.width / factor;
  result.height = camera.height / factor;
  result.fx = camera.fx / factor;
  result.fy = camera.fy / factor;
  result.cx = (camera.cx - offset) / factor;
  result.cy = (camera.cy - offset) / factor;
  return result;
}

}  // namespace berth::host
