#include "pose/outline_geometry.hpp"

#include "camera/projection.hpp"
#include "fixed/roots.hpp"

namespace berth {
namespace {

constexpr std::int32_t kMaxJacobian = 1 << 15;  // 1024 px per unit

struct PlanePoint {
  Vec3Mm place;
  Unit tangent_x, tangent_y;
  Unit white_x, white_y;  // towards white, in the marker's plane
};

Mm distance(Mm x, Mm y) { return Mm::saturated(hypot(x.raw(), y.raw())); }

PlanePoint point_of(const OutlinePiece& piece, const SinCos& a, int index) {
  PlanePoint p;
  p.place = piece.origin;
  if (piece.is_arc) {
    p.place[0] += piece.radius_mm * a.cos;
    p.place[1] += piece.radius_mm * a.sin;
    p.tangent_x = -a.sin;
    p.tangent_y = a.cos;
    p.white_x = piece.is_hole ? a.cos : -a.cos;
    p.white_y = piece.is_hole ? a.sin : -a.sin;
  } else {
    p.place[0] += Mm::from_wide(std::int64_t{piece.step_x_mm.raw()} * index);
    p.place[1] += Mm::from_wide(std::int64_t{piece.step_y_mm.raw()} * index);
    p.tangent_x = piece.along_x;
    p.tangent_y = piece.along_y;
    p.white_x = -piece.along_y;
    p.white_y = piece.along_x;
  }
  return p;
}

// A = d(image) / d(plane), px per mm, columns by the plane's x and y.
struct PlaneJacobian {
  PxPerMm by_x[2], by_y[2];
};

PlaneJacobian plane_jacobian(const Mat23PxPerMm& by_point, const Mat3Unit& r) {
  PlaneJacobian a;
  for (int i = 0; i < 2; ++i) {
    std::int64_t x = 0, y = 0;  // < 3 2^31 2^30
    for (int j = 0; j < 3; ++j) {
      x += std::int64_t{by_point(i, j).raw()} * r(j, 0).raw();
      y += std::int64_t{by_point(i, j).raw()} * r(j, 1).raw();
    }
    a.by_x[i] = PxPerMm::saturated(shift_round(x, 30));
    a.by_y[i] = PxPerMm::saturated(shift_round(y, 30));
  }
  return a;
}

void move_in_image(const PlaneJacobian& a, Unit x, Unit y, PxPerMm out[2]) {
  for (int i = 0; i < 2; ++i) out[i] = a.by_x[i] * x + a.by_y[i] * y;
}

// A^-1 in mm per px; false where the plane is seen edge-on.
bool invert(const PlaneJacobian& a, Q<16> inverse[2][2]) {
  const std::int64_t determinant =
      shift_round(std::int64_t{a.by_x[0].raw()} * a.by_y[1].raw(), 24) -
      shift_round(std::int64_t{a.by_x[1].raw()} * a.by_y[0].raw(), 24);  // Q<24>
  if (determinant < (1 << 12)) return false;
  const auto over = [&](PxPerMm v) {
    return Q<16>::saturated((std::int64_t{v.raw()} * (1 << 16)) / determinant);
  };
  inverse[0][0] = over(a.by_y[1]);
  inverse[0][1] = over(-a.by_y[0]);
  inverse[1][0] = over(-a.by_x[1]);
  inverse[1][1] = over(a.by_x[0]);
  return true;
}

std::int32_t clamp_jacobian(std::int64_t value) {
  if (value > kMaxJacobian) return kMaxJacobian;
  if (value < -kMaxJacobian) return -kMaxJacobian;
  return static_cast<std::int32_t>(value);
}

// J = (R P x c, c lever) with c = n^T du/dp in px/mm.
void fill_jacobian(const OutlineView& view, const Mat23PxPerMm& by_point, const Vec3Mm& arm,
                   OutlineVertex& vertex) {
  std::int32_t c[3];  // Q<24>
  for (int j = 0; j < 3; ++j) {
    c[j] = saturate32(shift_round(std::int64_t{by_point(0, j).raw()} * vertex.normal_x.raw() +
                                      std::int64_t{by_point(1, j).raw()} * vertex.normal_y.raw(),
                                  16));
    vertex.jacobian[3 + j] =
        clamp_jacobian(shift_by(c[j], view.lever_log2 + kJacobianFraction - 24));
  }
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    // |arm| < 2^28 (1 m): products below 2^59
    const std::int64_t cross =
        std::int64_t{arm[j].raw()} * c[k] - std::int64_t{arm[k].raw()} * c[j];
    vertex.jacobian[i] = clamp_jacobian(shift_round(cross, 18 + 24 - kJacobianFraction));
  }
}

// A window's reach on the plate, by a 32-bit division: 0.1 % where 0.8 px are a millimetre.
Mm to_mm(Px px, PxPerMm scale) {
  BERTH_RANGE(px.raw() >= 0 && px.raw() < 1 << 20 && scale.raw() >= 1 << 14);
  return Mm::from_raw(static_cast<std::int32_t>((static_cast<std::uint32_t>(px.raw()) << 12) /
                                                    static_cast<std::uint32_t>(scale.raw() >> 14) &
                                                0x7fffffffu));
}

Px to_px(Mm mm, PxPerMm scale) {
  return Px::saturated(shift_round(std::int64_t{mm.raw()} * scale.raw(), 18 + 24 - 16));
}

std::int64_t product(Mm a, Mm b) { return std::int64_t{a.raw()} * b.raw(); }

bool is_nearer(Mm x, Mm y, Mm than) { return product(x, x) + product(y, y) < product(than, than); }

// Whether collar or post hide the place, or come nearer than the scan window reaches.
bool is_shaded(const OutlineView& view, const PlanePoint& p, Mm margin) {
  const Mm dx = p.place[0] - view.shade_x, dy = p.place[1] - view.shade_y;
  if (is_nearer(dx, dy, view.shade_collar + margin)) return true;
  // The post runs from the dot's foot F to the shade's centre S: distance of the place to F S.
  const Dot& dot = view.target->dots[0];
  const Mm px = p.place[0] - dot.center_mm[0], py = p.place[1] - dot.center_mm[1];
  const Mm reach = view.shade_post + margin;
  const std::int64_t along = product(px, view.post_x) + product(py, view.post_y);
  if (along <= 0 || view.post_length.raw() == 0) return is_nearer(px, py, reach);
  if (along > product(view.post_length, view.post_length)) return false;  // the collar was tested
  const std::int64_t across = product(px, view.post_y) - product(py, view.post_x);
  return (across < 0 ? -across : across) < product(reach, view.post_length);
}

// Free black beside the outline, where the raised dot's image may come close.
Px free_outside(const OutlineView& view, const OutlinePiece& piece, const PlanePoint& p,
                PxPerMm scale) {
  Mm free = piece.clearance_mm;
  if (view.has_shade && piece.raised < 0) {
    const Mm dx = p.place[0] - view.shade_x, dy = p.place[1] - view.shade_y;
    if (is_nearer(dx, dy, free + view.shade_dot)) free = distance(dx, dy) - view.shade_dot;
  }
  return to_px(free, scale);
}

// What a raised dot has behind its collar's rim must be black as far as blur carries it.
bool has_clear_rim(const OutlineView& view, const PlanePoint& p, Mm margin) {
  const Dot& dot = view.target->dots[0];
  const Mm gap = dot.collar_radius_mm - dot.radius_mm;
  // The rim beside this place, seen on the plate: eye + k (rim - eye).
  const Mm rim_x = p.place[0] - gap * p.white_x, rim_y = p.place[1] - gap * p.white_y;
  const Mm x = rim_x + (rim_x - view.eye_x) * view.shade_scale_minus_one;
  const Mm y = rim_y + (rim_y - view.eye_y) * view.shade_scale_minus_one;
  const Mm from_center = distance(x, y);
  return from_center + margin < view.target->ring_inner_mm ||
         from_center - margin > view.target->ring_outer_mm;
}

}  // namespace

int lever_log2_of(const TargetModel& target) {
  int lever_log2 = 0;
  while (lever_log2 < 8 && Mm(1 << lever_log2) < target.ring_outer_mm) ++lever_log2;
  return lever_log2;
}

OutlineView make_outline_view(const Camera& camera, const TargetModel& target,
                              const RigidTransform& pose, Px reach_px) {
  OutlineView view;
  view.camera = &camera;
  view.target = &target;
  view.pose = pose;
  view.reach_px = reach_px;
  view.lever_log2 = lever_log2_of(target);
  const Vec3Mm eye = pose.rotation.transpose() * pose.translation_mm;  // minus the camera's place
  view.eye_x = -eye[0];
  view.eye_y = -eye[1];
  view.eye_height = eye[2];
  if (!target.has_raised_dot()) return view;
  const Dot& dot = target.dots[0];
  const Mm height = -dot.center_mm[2];
  if (view.eye_height - height <= height) return view;  // closer than any envelope
  view.has_shade = true;
  const Unit k1 = div<30>(height, view.eye_height - height);  // k - 1, below 1
  view.shade_scale_minus_one = k1;
  view.shade_x = dot.center_mm[0] + (dot.center_mm[0] - view.eye_x) * k1;
  view.shade_y = dot.center_mm[1] + (dot.center_mm[1] - view.eye_y) * k1;
  view.shade_collar = dot.collar_radius_mm + dot.collar_radius_mm * k1;
  view.shade_dot = dot.radius_mm + dot.radius_mm * k1;
  view.shade_post = dot.post_radius_mm + dot.post_radius_mm * k1;
  view.post_x = view.shade_x - dot.center_mm[0];
  view.post_y = view.shade_y - dot.center_mm[1];
  view.post_length = distance(view.post_x, view.post_y);
  return view;
}

bool place_by_pixel(const OutlineView& view, const Vec3Mm& place, Q<16> place_by_px[2][2]) {
  const Mat3Unit& r = view.pose.rotation;
  const Vec3Mm seen = r * place + view.pose.translation_mm;
  if (seen[2].raw() <= 0) return false;
  const Projection projection = project_with_jacobian(*view.camera, seen);
  return invert(plane_jacobian(projection.by_point, r), place_by_px);
}

namespace {

OutlineVertex make_vertex(const OutlineView& view, const OutlinePiece& piece, const PlanePoint& p) {
  OutlineVertex vertex;
  vertex.place_x = p.place[0];
  vertex.place_y = p.place[1];
  const Mat3Unit& r = view.pose.rotation;
  const Vec3Mm arm = r * p.place;
  const Vec3Mm seen = arm + view.pose.translation_mm;
  if (seen[2].raw() <= 0) return vertex;
  const Projection projection = project_with_jacobian(*view.camera, seen);
  vertex.point_px = projection.pixel;

  PxPerMm tangent[2], inward[2];
  const PlaneJacobian plane = plane_jacobian(projection.by_point, r);
  move_in_image(plane, p.tangent_x, p.tangent_y, tangent);
  move_in_image(plane, p.white_x, p.white_y, inward);
  const std::uint32_t length = hypot(tangent[0].raw(), tangent[1].raw());
  if (length < (1u << 14)) return vertex;  // seen along its own plane
  const Reciprocal one_over = reciprocal(length);
  vertex.normal_x = Q<16>::from_wide(-multiply_reciprocal(tangent[1].raw(), one_over, 16));
  vertex.normal_y = Q<16>::from_wide(multiply_reciprocal(tangent[0].raw(), one_over, 16));
  PxPerMm scale = inward[0] * vertex.normal_x.to<24>() + inward[1] * vertex.normal_y.to<24>();
  if (scale.raw() < 0) {
    vertex.normal_x = -vertex.normal_x;
    vertex.normal_y = -vertex.normal_y;
    scale = -scale;
  }
  if (scale.raw() < (1 << 14)) return vertex;
  fill_jacobian(view, projection.by_point, arm, vertex);
  vertex.width_px = to_px(piece.width_mm, scale);
  vertex.outside_px = free_outside(view, piece, p, scale);

  vertex.visible = true;
  if (view.has_shade) {
    const Mm margin = to_mm(view.reach_px, scale);
    if (piece.raised < 0) vertex.visible = !is_shaded(view, p, margin);
    if (piece.raised >= 0) vertex.visible = has_clear_rim(view, p, margin);
  }
  return vertex;
}

}  // namespace

OutlineWalk::OutlineWalk(const OutlineView& view, const OutlinePiece& piece)
    : view_(&view), piece_(&piece) {
  if (!piece.is_arc) return;
  at_ = sin_cos(piece.first_angle);
  step_ = sin_cos(piece.step_angle);
}

OutlineVertex OutlineWalk::next() {
  const PlanePoint p = point_of(*piece_, at_, index_++);
  const Unit cos = at_.cos * step_.cos - at_.sin * step_.sin;
  at_.sin = at_.sin * step_.cos + at_.cos * step_.sin;
  at_.cos = cos;
  return make_vertex(*view_, *piece_, p);
}

OutlineMiddle middle_of(const OutlineVertex& a, const OutlineVertex& b) {
  constexpr std::int32_t kOne = 1 << 16;
  const std::int32_t x = (a.normal_x.raw() + b.normal_x.raw()) / 2;
  const std::int32_t y = (a.normal_y.raw() + b.normal_y.raw()) / 2;
  const std::int64_t square = shift_round(std::int64_t{x} * x + std::int64_t{y} * y, 16);
  // Up to 60 degrees; beyond lies no outline of ours.
  const auto short_of = static_cast<std::int32_t>(square < kOne / 4 * 3 ? kOne / 4 : kOne - square);
  const std::int32_t second = (short_of * (short_of >> 2)) >> 14;  // s^2, Q<16>
  // 1 / sqrt(1 - s), and that times sin(t) / t for s = sin(t)^2.
  const std::int32_t to_unit = kOne + short_of / 2 + (3 * second) / 8;
  const std::int32_t to_mean = kOne + short_of / 3 + (29 * second) / 100;
  OutlineMiddle middle;
  middle.normal_x = Q<16>::from_wide(shift_round(std::int64_t{x} * to_unit, 16));
  middle.normal_y = Q<16>::from_wide(shift_round(std::int64_t{y} * to_unit, 16));
  for (int i = 0; i < 6; ++i) {
    const std::int32_t sum = (a.jacobian[i] + b.jacobian[i]) / 2;
    middle.jacobian[i] = clamp_jacobian(shift_round(std::int64_t{sum} * to_mean, 16));
  }
  return middle;
}

void shift_along_normal(const std::int64_t (&step)[kOutlineUnknowns], OutlineVertex& vertex) {
  std::int64_t shift = 0;  // Q<35>, below 6 2^15 2^27
  for (int i = 0; i < 6; ++i) shift += vertex.jacobian[i] * step[i];
  const std::int64_t px = shift_round(shift, 35 - 16);
  vertex.point_px[0] += Px::saturated(shift_round(px * vertex.normal_x.raw(), 16));
  vertex.point_px[1] += Px::saturated(shift_round(px * vertex.normal_y.raw(), 16));
}

}  // namespace berth
