// Everything that determines a rendered frame.
//
// Radiance is in digital numbers (DN) of the camera at unit gain and may exceed 255. The optics
// blur the radiance of the scene (albedo times light, and glints); then come vignetting, stray
// light, gamma, noise, rounding and clipping.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace berth::host {

/// p_C = R p_T + t, millimetres; target frame and camera frame as in the target's description.
struct Pose {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();
};

/// The edge of a cast shadow: points of the plate with nx X + ny Y > offset lie in the shadow.
struct Shadow {
  double normal_x = 1;
  double normal_y = 0;
  double offset_mm = 0;
  double penumbra_mm = 0;  ///< full width of the soft edge
  double leaves = 0.5;     ///< fraction of the light left in the shadow
};

/// Grey levels at the plate's brightest place, and how the light falls off from there.
struct Light {
  double white_dn = 200;
  double black_dn = 30;
  double stray_dn = 0;            ///< part of both levels that no shadow takes away
  double gradient_ratio = 1;      ///< brightest over darkest place of the plate
  double gradient_angle_rad = 0;  ///< direction of rising light, from the plate's x towards y
  std::optional<Shadow> shadow;
};

enum class PsfKind { kGaussian, kDisc, kBox };

struct Optics {
  PsfKind psf = PsfKind::kGaussian;
  double defocus_px = 0.7;  ///< standard deviation of the defocus in each axis, for every kind
  double motion_px = 0;     ///< length of the straight motion; mid-exposure is its middle
  double motion_angle_rad = 0;
  double vignetting = 0;  ///< relative loss of light at the image's corner
  double gamma = 1;       ///< response 255 (x / 255)^gamma
};

enum class BackgroundKind { kPlain, kDark, kBright, kClutter };

struct Background {
  BackgroundKind kind = BackgroundKind::kPlain;
  double level_dn = 110;
  uint64_t seed = 0;
};

/// A bright spot on the plate: peak (1 - r^2 / radius^2)^2.
struct Glint {
  double x_mm = 0, y_mm = 0;
  double radius_mm = 0;
  double peak_dn = 0;
};

/// Something opaque in front of a marker: a polygon at constant z of the target frame.
struct Occluder {
  std::string marker;  ///< the marker it hides: "D2", "ring" (a quarter), "line" (a half)
  double z_mm = 0;
  std::vector<std::array<double, 2>> outline_mm;
  double level_dn = 0;
};

/// Where the camera looks from, as it was drawn; the renderer reads only the pose made from it.
struct Viewpoint {
  double distance_mm = 0;
  double tilt_deg = 0;            ///< between the plate's outward normal and the line of sight
  double tilt_direction_deg = 0;  ///< axis of the tilt, from the camera's x towards y
  double roll_deg = 0;
  std::array<double, 2> center_px{};  ///< image of the plate's centre
};

struct Scene {
  uint64_t seed = 0;
  uint64_t index = 0;
  Viewpoint viewpoint;
  Pose pose;
  bool has_target = true;
  bool is_plate_inside = true;  ///< whether the whole target lies in the image
  Light light;
  Optics optics;
  Background background;
  std::vector<Glint> glints;
  std::vector<Occluder> occluders;
  double noise_dn = 2;
  uint64_t noise_seed = 0;

  /// The lowest unshadowed difference of white and black across the plate, after clipping.
  double contrast_dn() const;
  /// Name of the marker that an occluder hides, or empty.
  std::string hidden_marker() const;
};

}  // namespace berth::host
