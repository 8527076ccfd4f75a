// Random poses of the operating envelope and ideal measurements of CT-1, in double.
#pragma once

#include <Eigen/Dense>
#include <random>
#include <vector>

#include "pose/pose.hpp"

namespace berth::test {

struct PoseD {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation_mm = Eigen::Vector3d::Zero();
  double tilt_rad = 0;
};

struct CameraD {
  double fx = 1250, fy = 1250, cx = 515.3, cy = 508.7;
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;
};

CameraD ideal_camera();  // HEC-1 without distortion
CameraD hec1_camera();
Camera to_fixed(const CameraD& camera);
PoseD to_double(const RigidTransform& pose);
RigidTransform to_fixed(const PoseD& pose);

/// CT-1 with all lengths scaled; without the raised dot when `is_flat` (CT-1F).
TargetModel ct1(double scale = 1, bool is_flat = false);

Eigen::Vector2d project(const CameraD& camera, const Eigen::Vector3d& point_mm);
/// Normalised image coordinates of a pixel, by Newton to 1e-15.
Eigen::Vector2d undistort(const CameraD& camera, const Eigen::Vector2d& pixel);
Eigen::Vector3d dot_center(const TargetModel& target, int index);

/// Outline of a marker: for the ring the outer one or (`is_inner`) the inner.
Eigen::Vector2d area_centroid(const CameraD& camera, const PoseD& pose, const TargetModel& target,
                              MarkerKind kind, int index);

double rotation_error_rad(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b);

/// Cramer-Rao bound of CT-1 on clean images (rotation rad, translation mm), interpolated in the
/// table of the specification; the better of both tilts' ends is approached linearly.
struct Bound {
  double rotation_rad, translation_mm;
};
Bound clean_bound(const PoseD& pose, double scale = 1);

/// Distance log-uniform in 300..1500 mm, tilt 0..40 deg, its direction and roll uniform, image
/// position uniform with the whole plate in the image.
class Envelope {
 public:
  explicit Envelope(std::uint64_t seed) : random_(seed) {}
  PoseD draw(const CameraD& camera, double scale = 1);
  PoseD draw_at(const CameraD& camera, double distance_mm, double tilt_rad, double scale = 1);
  double uniform(double low, double high);
  double normal();

 private:
  std::mt19937_64 random_;
};

/// Markers at given centroids with isotropic sigma; `count_dots` first dots, others by flags.
MarkerSet markers_at(const TargetModel& target, const std::vector<Eigen::Vector2d>& dots_px,
                     double sigma_px);
/// Adds ring or line.
void add_marker(MarkerSet& set, MarkerKind kind, const Eigen::Vector2d& center_px, double sigma_px);

}  // namespace berth::test
