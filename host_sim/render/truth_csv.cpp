#include "host_sim/render/truth_csv.hpp"

#include <fmt/format.h>

#include <cmath>

#include "host_sim/render/det_math.hpp"

namespace berth::host {
namespace {

const char* name_of(BackgroundKind kind) {
  switch (kind) {
    case BackgroundKind::kPlain:
      return "plain";
    case BackgroundKind::kDark:
      return "dark";
    case BackgroundKind::kBright:
      return "bright";
    case BackgroundKind::kClutter:
      return "clutter";
  }
  return "";
}

std::string pose_fields(const Scene& scene) {
  if (!scene.has_target) return ",,,,,,";
  const Eigen::Vector3d& t = scene.pose.t;
  const auto q = quaternion_from_rotation(scene.pose.R);
  return fmt::format("{:.9f},{:.9f},{:.9f},{:.12f},{:.12f},{:.12f},{:.12f}", t.x(), t.y(), t.z(),
                     q[0], q[1], q[2], q[3]);
}

std::string light_fields(const Light& light) {
  return fmt::format("{:.3f},{:.3f},{:.3f},{:.4f},{:.3f},{:.4f}", light.white_dn, light.black_dn,
                     light.stray_dn, light.gradient_ratio, light.gradient_angle_rad / kRadPerDeg,
                     light.shadow ? light.shadow->leaves : 1.0);
}

std::string optics_fields(const Scene& scene) {
  const Optics& optics = scene.optics;
  return fmt::format("{:.4f},{:.4f},{:.4f},{:.3f},{:.4f},{:.4f}", scene.noise_dn, optics.defocus_px,
                     optics.motion_px, optics.motion_angle_rad / kRadPerDeg, optics.vignetting,
                     optics.gamma);
}

}  // namespace

// Shepperd's method: the largest of the four components is computed first.
std::array<double, 4> quaternion_from_rotation(const Eigen::Matrix3d& R) {
  const double trace = R(0, 0) + R(1, 1) + R(2, 2);
  std::array<double, 4> q{};
  int largest = 0;
  for (int i = 1; i < 4; ++i) {
    const double value = R(i - 1, i - 1);
    if (value > (largest == 0 ? trace : R(largest - 1, largest - 1))) largest = i;
  }
  if (largest == 0) {
    q = {1.0 + trace, R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1)};
  } else {
    const int i = largest - 1;
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    q[0] = R(k, j) - R(j, k);
    q[i + 1] = 1.0 + R(i, i) - R(j, j) - R(k, k);
    q[j + 1] = R(j, i) + R(i, j);
    q[k + 1] = R(k, i) + R(i, k);
  }
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  const double scale = q[0] < 0.0 ? -1.0 / norm : 1.0 / norm;
  for (double& c : q) c *= scale;
  return q;
}

std::string truth_header() {
  return "file,tx_mm,ty_mm,tz_mm,qw,qx,qy,qz,distance_mm,tilt_deg,tilt_direction_deg,roll_deg,"
         "white_dn,black_dn,stray_dn,gradient_ratio,gradient_deg,shadow_leaves,noise_dn,"
         "defocus_px,motion_px,motion_deg,vignetting,gamma,contrast_dn,hidden,glint,background";
}

std::string truth_row(const std::string& file, const Scene& scene) {
  const Viewpoint& view = scene.viewpoint;
  return fmt::format("{},{},{:.6f},{:.6f},{:.6f},{:.6f},{},{},{:.3f},{},{},{}", file,
                     pose_fields(scene), view.distance_mm, view.tilt_deg, view.tilt_direction_deg,
                     view.roll_deg, light_fields(scene.light), optics_fields(scene),
                     scene.contrast_dn(), scene.hidden_marker(), scene.glints.empty() ? 0 : 1,
                     name_of(scene.background.kind));
}

}  // namespace berth::host
