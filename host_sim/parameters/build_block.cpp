#include "host_sim/parameters/build_block.hpp"

#include <Eigen/Dense>
#include <cmath>

#include "app/parameter_block.hpp"

namespace berth::host {
namespace {

constexpr double kPi = 3.14159265358979323846;

// Rounds to Q formats and remembers the first value that does not fit, so that the conversions
// below read as lists of fields.
class Rounder {
 public:
  template <int F>
  void operator()(double value, Q<F>& out, const std::string& field) {
    const double scaled = std::floor(std::ldexp(value, F) + 0.5);
    if (!(scaled >= INT32_MIN && scaled <= INT32_MAX)) return refuse(field, value);
    out = Q<F>::from_raw(static_cast<std::int32_t>(scaled));
  }

  const std::string& error() const { return error_; }

 private:
  void refuse(const std::string& field, double value) {
    if (error_.empty()) {
      error_ = "value out of range: " + field + " = " + std::to_string(value) +
               " does not fit the parameter block";
    }
  }

  std::string error_;
};

void round_camera(const Camera& from, Rounder& round, berth::Camera& to) {
  to.width = from.width;
  to.height = from.height;
  round(from.fx, to.fx, "camera.fx");
  round(from.fy, to.fy, "camera.fy");
  round(from.cx, to.cx, "camera.cx");
  round(from.cy, to.cy, "camera.cy");
  round(from.k1, to.k1, "camera.k1");
  round(from.k2, to.k2, "camera.k2");
  round(from.p1, to.p1, "camera.p1");
  round(from.p2, to.p2, "camera.p2");
  round(from.k3, to.k3, "camera.k3");
}

void round_dot(const Dot& from, const std::string& name, Rounder& round, berth::Dot& to) {
  constexpr const char* kAxes[] = {"x_mm", "y_mm", "z_mm"};
  for (int axis = 0; axis < 3; ++axis) {
    round(from.center[static_cast<std::size_t>(axis)], to.center_mm[axis], name + kAxes[axis]);
  }
  round(from.radius, to.radius_mm, name + "radius_mm");
  round(from.collar_radius, to.collar_radius_mm, name + "collar_radius_mm");
  round(from.post_radius, to.post_radius_mm, name + "post_radius_mm");
}

void round_target(const Target& from, Rounder& round, TargetModel& to) {
  round(from.plate_size_mm[0], to.plate_width_mm, "target.plate_width_mm");
  round(from.plate_size_mm[1], to.plate_height_mm, "target.plate_height_mm");
  to.white_on_black = from.white_on_black;
  round(from.ring.outer, to.ring_outer_mm, "target.ring_outer_mm");
  round(from.ring.inner, to.ring_inner_mm, "target.ring_inner_mm");
  round(from.line.center[0], to.line_x_mm, "target.line_x_mm");
  round(from.line.center[1], to.line_y_mm, "target.line_y_mm");
  round(from.line.length, to.line_length_mm, "target.line_length_mm");
  round(from.line.width, to.line_width_mm, "target.line_width_mm");
  const double half_turns = std::remainder(from.line.angle_deg, 360.0) / 180.0;
  round(half_turns * kPi, to.line_angle, "target.line_angle");
  to.dot_count = static_cast<std::int32_t>(from.dots.size());
  for (std::size_t i = 0; i < from.dots.size(); ++i) {
    round_dot(from.dots[i], "target.dots[" + std::to_string(i) + "].", round, to.dots[i]);
  }
}

/// The rotation nearest to the matrix in the Frobenius norm (its polar factor).
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& matrix) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

void round_transform(const Eigen::Matrix4d& from, const std::string& name, Rounder& round,
                     RigidTransform& to) {
  const Eigen::Matrix3d rotation = nearest_rotation(from.topLeftCorner<3, 3>());
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 3; ++col) {
      round(rotation(row, col), to.rotation(row, col), name + ".rotation");
    }
    round(from(row, 3), to.translation_mm[row],
          name + ".translation_mm[" + std::to_string(row) + "]");
  }
}

std::string text_of(const BlockStatus& status) {
  char text[kBlockText_bytes];
  return describe(status, text);
}

}  // namespace

tl::expected<berth::Parameters, std::string> make_parameters(const Camera& camera,
                                                             const Target& target,
                                                             const Mount& mount, const Mode& mode) {
  if (target.dots.size() > static_cast<std::size_t>(kMaxDots)) {
    return tl::make_unexpected("value out of range: target.dots has more than " +
                               std::to_string(kMaxDots) + " dots");
  }
  berth::Parameters parameters;
  Rounder round;
  round_camera(camera, round, parameters.camera);
  round_target(target, round, parameters.target);
  round_transform(mount.T_EC, "mount.T_EC", round, parameters.effector_from_camera);
  round_transform(mount.T_TL, "mount.T_TL", round, parameters.target_from_latch);
  parameters.mode = mode;
  if (!round.error().empty()) return tl::make_unexpected(round.error());
  const BlockStatus status = validate_parameters(parameters);
  if (!status.is_ok()) return tl::make_unexpected(text_of(status));
  return parameters;
}

tl::expected<std::vector<std::uint8_t>, std::string> build_parameter_block(const Camera& camera,
                                                                           const Target& target,
                                                                           const Mount& mount,
                                                                           const Mode& mode) {
  const auto parameters = make_parameters(camera, target, mount, mode);
  if (!parameters) return tl::make_unexpected(parameters.error());
  std::vector<std::uint8_t> block(kMaxParameterBlock_bytes);
  block.resize(encode_parameter_block(*parameters, block));
  berth::Parameters decoded;
  const BlockStatus status = decode_parameter_block(block, decoded);
  if (!status.is_ok()) return tl::make_unexpected(text_of(status));
  return block;
}

}  // namespace berth::host
