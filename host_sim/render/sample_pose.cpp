#include "host_sim/render/sample_pose.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/render/det_math.hpp"
#include "host_sim/render/random.hpp"

namespace berth::host {
namespace {

// Products are written out, so that the order of additions does not depend on the machine.
Eigen::Matrix3d multiply(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  Eigen::Matrix3d c;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) c(i, j) = a(i, 0) * b(0, j) + a(i, 1) * b(1, j) + a(i, 2) * b(2, j);
  }
  return c;
}

Eigen::Matrix3d rotation_x(double angle_rad) {
  const SinCos a = det_sincos(angle_rad);
  Eigen::Matrix3d R;
  R << 1, 0, 0, 0, a.cos, -a.sin, 0, a.sin, a.cos;
  return R;
}

Eigen::Matrix3d rotation_z(double angle_rad) {
  const SinCos a = det_sincos(angle_rad);
  Eigen::Matrix3d R;
  R << a.cos, -a.sin, 0, a.sin, a.cos, 0, 0, 0, 1;
  return R;
}

// The shortest rotation that takes (0, 0, 1) to the unit vector m: I + [v] + [v]^2 / (1 + m_z)
// with v = (-m_y, m_x, 0).
Eigen::Matrix3d rotation_to(const Eigen::Vector3d& m) {
  const double k = 1.0 / (1.0 + m.z());
  Eigen::Matrix3d R;
  R << 1.0 - k * m.x() * m.x(), -k * m.x() * m.y(), m.x(),  //
      -k * m.x() * m.y(), 1.0 - k * m.y() * m.y(), m.y(),   //
      -m.x(), -m.y(), m.z();
  return R;
}

Eigen::Vector3d line_of_sight(const Camera& camera, const std::array<double, 2>& pixel) {
  const Eigen::Vector2d p(pixel[0], pixel[1]);
  const Eigen::Vector2d ray = undistort(camera, p).value_or(Eigen::Vector2d(0.0, 0.0));
  const double norm = std::sqrt(ray.x() * ray.x() + ray.y() * ray.y() + 1.0);
  return {ray.x() / norm, ray.y() / norm, 1.0 / norm};
}

// A box that surely holds every place of the centre at which the plate is in the image: the image
// less a part of the plate's extent at the principal point.
struct Box {
  double left, top, right, bottom;
};

Box candidate_box(const Viewpoint& viewpoint, const Camera& camera, const Target& target) {
  constexpr double kSurePart = 0.7;  // how much distortion and perspective may shrink the plate
  Viewpoint central = viewpoint;
  central.center_px = {camera.cx, camera.cy};
  const Pose pose = pose_from_viewpoint(central, camera);
  Box extent{0, 0, 0, 0};
  for (const Eigen::Vector2d& p : project_plate({camera, pose}, target)) {
    extent.left = std::max(extent.left, camera.cx - p.x());
    extent.top = std::max(extent.top, camera.cy - p.y());
    extent.right = std::max(extent.right, p.x() - camera.cx);
    extent.bottom = std::max(extent.bottom, p.y() - camera.cy);
  }
  return {kSurePart * extent.left, kSurePart * extent.top,
          camera.width - 1.0 - kSurePart * extent.right,
          camera.height - 1.0 - kSurePart * extent.bottom};
}

}  // namespace

Pose pose_from_viewpoint(const Viewpoint& viewpoint, const Camera& camera) {
  const Eigen::Vector3d sight = line_of_sight(camera, viewpoint.center_px);
  const double direction = viewpoint.tilt_direction_deg * kRadPerDeg;
  const double roll = viewpoint.roll_deg * kRadPerDeg;
  Pose pose;
  pose.R =
      multiply(multiply(rotation_to(sight), rotation_z(direction)),
               multiply(rotation_x(viewpoint.tilt_deg * kRadPerDeg), rotation_z(roll - direction)));
  pose.t = {viewpoint.distance_mm * sight.x(), viewpoint.distance_mm * sight.y(),
            viewpoint.distance_mm * sight.z()};
  return pose;
}

bool sample_position(double u, double v, uint64_t seed, const Camera& camera, const Target& target,
                     Viewpoint& viewpoint) {
  constexpr int kCandidates = 300;
  const Box box = candidate_box(viewpoint, camera, target);
  Random random(seed);
  if (box.left < box.right && box.top < box.bottom) {
    for (int i = 0; i < kCandidates; ++i) {
      viewpoint.center_px = {box.left + u * (box.right - box.left),
                             box.top + v * (box.bottom - box.top)};
      const Pose pose = pose_from_viewpoint(viewpoint, camera);
      if (is_inside_image({camera, pose}, target)) return true;
      u = random.uniform();
      v = random.uniform();
    }
  }
  viewpoint.center_px = {0.5 * (camera.width - 1), 0.5 * (camera.height - 1)};
  return is_inside_image({camera, pose_from_viewpoint(viewpoint, camera)}, target);
}

}  // namespace berth::host
