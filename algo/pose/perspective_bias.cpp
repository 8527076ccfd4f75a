// See perspective_bias.hpp; formats and ranges in docs/pose.md.
#include "pose/perspective_bias.hpp"

#include "fixed/roots.hpp"
#include "fixed/trigonometry.hpp"
#include "fixed/wide.hpp"

namespace berth {
namespace {

constexpr Unit kHalfRoot2 = q<30>(0.70710678118654752440);

void add_node(MarkerNodes& nodes, Mm x, Mm y, Unit weight) {
  nodes.point_mm[nodes.count] = nodes.center_mm + Vec3Mm(x, y, Mm(0));
  nodes.weight[nodes.count] = weight;
  ++nodes.count;
}

void add_dot_nodes(MarkerNodes& nodes, Mm radius) {
  const Mm rho = radius * kHalfRoot2;  // E[r^2] = radius^2 / 2
  const Unit weight = q<30>(0.25);
  add_node(nodes, rho, Mm(0), weight);
  add_node(nodes, -rho, Mm(0), weight);
  add_node(nodes, Mm(0), rho, weight);
  add_node(nodes, Mm(0), -rho, weight);
}

void add_ring_nodes(MarkerNodes& nodes, Mm outer, Mm inner) {
  // E[r^2] = (outer^2 + inner^2) / 2
  const Mm root2_rho = Mm::from_wide(hypot(outer.raw(), inner.raw()));
  const Mm rho = root2_rho * kHalfRoot2, diagonal = rho * kHalfRoot2;
  const Unit weight = q<30>(0.125);
  for (const Mm x : {rho, -rho}) {
    add_node(nodes, x, Mm(0), weight);
    add_node(nodes, Mm(0), x, weight);
  }
  for (const Mm x : {diagonal, -diagonal}) {
    add_node(nodes, x, diagonal, weight);
    add_node(nodes, x, -diagonal, weight);
  }
}

void add_line_nodes(MarkerNodes& nodes, const TargetModel& target) {
  const SinCos turn = sin_cos(target.line_angle);
  const Mm along = mul<18>(target.line_length_mm, q<30>(0.38729833462074168852));  // sqrt(3/5) / 2
  const Mm across = mul<18>(target.line_width_mm, q<30>(0.28867513459481288225));  // sqrt(1/3) / 2
  for (const Mm a : {-along, Mm(0), along}) {
    const Unit weight = a == Mm(0) ? q<30>(2.0 / 9.0) : q<30>(5.0 / 36.0);
    for (const Mm b : {-across, across}) {
      add_node(nodes, a * turn.cos - b * turn.sin, a * turn.sin + b * turn.cos, weight);
    }
  }
}

std::int64_t product(std::int32_t a, std::int32_t b) { return std::int64_t{a} * b; }

// (z_ref / z)^3 with 28 bits, saturated at 8.
std::int32_t depth_density(Mm z_ref, Mm z) {
  const Reciprocal r = reciprocal(static_cast<std::uint32_t>(z.raw()));
  const std::int32_t ratio = saturate32(multiply_reciprocal(z_ref.raw(), r, 28));
  const std::int32_t square = saturate32(shift_round(product(ratio, ratio), 28));
  return saturate32(shift_round(product(square, ratio), 28));
}

// |det| of d pixel / d ray over 2^shift, saturated below 2^31.
std::int32_t distortion_density(const Mat2Px& by_ray, int shift) {
  const auto entry = [&](int i, int j) { return by_ray(i, j).raw() / 4; };  // < 2^29
  const std::int64_t det = product(entry(0, 0), entry(1, 1)) - product(entry(0, 1), entry(1, 0));
  return saturate32(shift_round(det < 0 ? -det : det, shift));
}

// Mean of pixels by density, relative to the first of them.
class WeightedMean {
 public:
  // False beyond 4096 px from the first: no marker is that large.
  bool add(const Vec2Px& pixel, Mm z, Unit weight, std::int32_t distortion) {
    if (mass_ == 0) {
      first_px_ = pixel;
      first_z_ = z;
    }
    const auto depth = static_cast<std::int32_t>(
        shift_round(product(depth_density(first_z_, z), weight.raw()), 30));
    const auto density = static_cast<std::int32_t>(shift_round(product(depth, distortion), 31));
    mass_ += density;  // each below 2^31
    for (int i = 0; i < 2; ++i) {
      const std::int64_t offset = std::int64_t{pixel[i].raw()} - first_px_[i].raw();
      constexpr std::int64_t kFar = std::int64_t{1} << 28;
      if (offset > kFar || offset < -kFar) return false;
      moment_[i] += product(density, static_cast<std::int32_t>(offset));  // below 8 * 2^59
    }
    return true;
  }

  bool get(Vec2Px& mean_px) const {
    if (mass_ <= 0) return false;
    for (int i = 0; i < 2; ++i) {
      mean_px[i] = Px::saturated(first_px_[i].raw() + div_shift(moment_[i], 0, mass_));
    }
    return true;
  }

 private:
  Vec2Px first_px_{Px(0), Px(0)};
  Mm first_z_;
  std::int64_t mass_ = 0, moment_[2] = {0, 0};
};

// d(u, v) / d(delta, dt) of one point: du = a . (delta x r + dt).
PoseJacobian pose_jacobian(const Mat23PxPerMm& by_point, const Vec3Mm& r) {
  constexpr std::int32_t kLimit = std::int32_t{1} << 28;
  PoseJacobian out;
  for (int i = 0; i < 2; ++i) {
    for (int k = 0; k < 3; ++k) {
      const int m = (k + 1) % 3, n = (k + 2) % 3;
      // Q18 mm * Q24 px/mm, |r| < 2^11 mm: below 2^61.
      const std::int64_t moment =
          product(r[m].raw(), by_point(i, n).raw()) - product(r[n].raw(), by_point(i, m).raw());
      const std::int32_t entry = saturate32(shift_round(moment, 18 + 24 - PoseJacobian::kFraction));
      out.row[i][k] = entry > kLimit ? kLimit : (entry < -kLimit ? -kLimit : entry);
      out.row[i][3 + k] = static_cast<std::int32_t>(shift_round(
          by_point(i, k).raw(), 24 - PoseJacobian::kFraction - PoseJacobian::kUnitBits));
    }
  }
  return out;
}

}  // namespace

MarkerNodes nodes_of(const TargetModel& target, MarkerKind kind, int index) {
  MarkerNodes nodes;
  if (kind == MarkerKind::kDot) {
    nodes.center_mm = target.dots[index].center_mm;
    add_dot_nodes(nodes, target.dots[index].radius_mm);
  } else if (kind == MarkerKind::kRing) {
    add_ring_nodes(nodes, target.ring_outer_mm, target.ring_inner_mm);
  } else {
    nodes.center_mm = {target.line_x_mm, target.line_y_mm, Mm(0)};
    add_line_nodes(nodes, target);
  }
  return nodes;
}

bool transform_point(const RigidTransform& camera_from_target, const Vec3Mm& point_mm,
                     Vec3Mm& rotated_mm, Vec3Mm& camera_mm) {
  for (int i = 0; i < 3; ++i) {
    std::int64_t sum = 0;  // Q48, |point| < 2^11 mm: below 2^60
    for (int k = 0; k < 3; ++k) {
      add_product(sum, camera_from_target.rotation(i, k).raw(), point_mm[k].raw());
    }
    const auto rotated = narrow<std::int32_t>(shift_round(sum, 30));  // |rotated| < 2^30
    std::int32_t camera;
    if (__builtin_add_overflow(rotated, camera_from_target.translation_mm[i].raw(), &camera)) {
      return false;
    }
    rotated_mm[i] = Mm::from_raw(rotated);
    camera_mm[i] = Mm::from_raw(camera);
  }
  return camera_mm[2] >= Mm(1);
}

[[gnu::noinline]] bool predict_centroid(const Camera& camera,
                                        const RigidTransform& camera_from_target,
                                        const MarkerNodes& nodes, Vec2Px& centroid_px) {
  // |d pixel / d ray| is about fx fy: scaled to 30 bits.
  const int bits = bit_length(std::int64_t{camera.fx.raw()} * camera.fy.raw()) - 4 - 30;
  const int shift = bits > 0 ? bits : 0;
  WeightedMean mean;
  for (int k = 0; k < nodes.count; ++k) {
    Vec3Mm rotated, point;
    if (!transform_point(camera_from_target, nodes.point_mm[k], rotated, point)) return false;
    const RayProjection p = distort_with_jacobian(camera, ray_of(point));
    const std::int32_t distortion = distortion_density(p.by_ray, shift);
    if (!mean.add(p.pixel, point[2], nodes.weight[k], distortion)) return false;
  }
  return mean.get(centroid_px);
}

bool predict_centroid(const Camera& camera, const RigidTransform& camera_from_target,
                      const MarkerNodes& nodes, PredictedCentroid& out) {
  Vec3Mm rotated, point;
  if (!transform_point(camera_from_target, nodes.center_mm, rotated, point)) return false;
  out.by_pose = pose_jacobian(project_with_jacobian(camera, point).by_point, rotated);
  return predict_centroid(camera, camera_from_target, nodes, out.centroid_px);
}

bool predict_centroid_roughly(const Camera& camera, const RigidTransform& camera_from_target,
                              const MarkerNodes& nodes, Vec2Px& centroid_px) {
  constexpr std::int32_t kUniform = std::int32_t{1} << 30;
  WeightedMean mean;
  for (int k = 0; k < nodes.count; ++k) {
    Vec3Mm rotated, point;
    if (!transform_point(camera_from_target, nodes.point_mm[k], rotated, point)) return false;
    if (!mean.add(project(camera, point), point[2], nodes.weight[k], kUniform)) return false;
  }
  return mean.get(centroid_px);
}

bool project_center(const Camera& camera, const RigidTransform& camera_from_target,
                    const MarkerNodes& nodes, Vec2Px& center_px) {
  Vec3Mm rotated, point;
  if (!transform_point(camera_from_target, nodes.center_mm, rotated, point)) return false;
  center_px = project(camera, point);
  return true;
}

}  // namespace berth
