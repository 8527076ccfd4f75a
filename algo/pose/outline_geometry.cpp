#include "pose/outline_geometry.hpp"

#include "camera/projection.hpp"
#include "fixed/roots.hpp"
#include "fixed/vector.hpp"

namespace berth {
namespace {

constexpr std::int32_t kMaxJacobian = 1 << 15;                           // 1024 px per unit
constexpr std::int32_t kLeastTangent = 1 << 12, kMostTangent = 1 << 29;  // px per unit of ray Q<12>

using Scale = Q<20>;  // px per mm

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

std::int32_t clamp_jacobian(std::int32_t value) {
  if (value > kMaxJacobian) return kMaxJacobian;
  return value < -kMaxJacobian ? -kMaxJacobian : value;
}

// R times a direction in the target's plane, Q<28>.
struct Direction {
  std::int32_t x, y, z;
};

Direction turned(const Mat3Unit& r, Unit x, Unit y) {
  const auto row = [&](int i) {
    return multiply_high(r(i, 0).raw(), x.raw()) + multiply_high(r(i, 1).raw(), y.raw());
  };
  return {row(0), row(1), row(2)};
}

// A unit vector of the image, Q<28>.
struct ImageUnit {
  std::int32_t x, y;
};

// Perpendicular, to its left, to the image's motion as the point moves along `t`, px per unit of
// depth and length: du = J (t_x - x t_z, t_y - y t_z). False where seen along its own plane.
bool normal_to(const PointProjection& p, const Direction& t, ImageUnit& normal) {
  // |ray| < 2 in both: below 3 2^28.
  const auto across = [&](std::int32_t component, Ray ray) {
    return component - multiply_high(raised(ray.raw(), 2), raised(t.z, 2));
  };
  const std::int32_t dx = across(t.x, p.ray[0]), dy = across(t.y, p.ray[1]);
  const auto moved = [&](int i) {  // Q<12>
    return multiply_high(p.by_ray(i, 0).raw(), dx) + multiply_high(p.by_ray(i, 1).raw(), dy);
  };
  std::int32_t u = moved(0), v = moved(1);
  const std::int32_t largest = (u < 0 ? -u : u) | (v < 0 ? -v : v);
  if (largest < kLeastTangent || largest >= kMostTangent) return false;
  // The larger one to 2^28, so that the length is below 2^30: 2 <= shift.
  const int up = leading_zeros32(static_cast<std::uint32_t>(largest)) - 3;
  u = raised(u, up);
  v = raised(v, up);
  const std::int32_t square = multiply_high(u, u) + multiply_high(v, v);  // 2^-32 of it
  const Reciprocal per_length = reciprocal(root_q16(static_cast<std::uint32_t>(square)));
  const auto over_length = [&](std::int32_t value) {
    return multiply_high(raised(value, per_length.shift - 2), per_length.mantissa);
  };
  normal = {-over_length(v), over_length(u)};
  return true;
}

// c = n^T du/dp, px/mm Q<22>, as far as 64; beyond lies no outline of ours.
struct Gradient {
  std::int32_t x, y, z;
};

Gradient gradient_of(const PointProjection& p, const ImageUnit& n, std::int32_t depth) {
  const std::int32_t limit = depth < (1 << 29) ? 4 * depth : INT32_MAX;
  const int left = p.per_z.shift - 4;
  const auto column = [&](int j) {
    std::int32_t g = multiply_high(raised(n.x, 2), p.by_ray(0, j).raw()) +  // px Q<14>
                     multiply_high(raised(n.y, 2), p.by_ray(1, j).raw());
    if (g > limit) g = limit;
    if (g < -limit) g = -limit;
    // z 2^shift is below 2^32, hence the factor below 2^30.
    return multiply_high(left >= 0 ? raised(g, left) : g >> -left, p.per_z.mantissa);
  };
  const std::int32_t x = column(0), y = column(1);
  const std::int32_t z = -multiply_high(raised(p.ray[0].raw(), 2), raised(x, 2)) -
                         multiply_high(raised(p.ray[1].raw(), 2), raised(y, 2));
  return {x, y, z};
}

// J = (R P x c, c lever).
void fill_jacobian(const OutlineView& view, const Gradient& c, const Vec3Mm& arm,
                   OutlineVertex& vertex) {
  const int down = 22 - kJacobianFraction - view.lever_log2;  // 9 to 17
  const auto along = [&](std::int32_t v) { return clamp_jacobian(lowered(v, down)); };
  vertex.jacobian[3] = along(c.x);
  vertex.jacobian[4] = along(c.y);
  vertex.jacobian[5] = along(c.z);
  const auto about = [](Mm a, std::int32_t of_b, Mm b, std::int32_t of_a) {
    // |arm| < 2^28 (1 m): products below 2^58. Q<40>, of which the upper half is Q<8>.
    const std::int64_t cross = std::int64_t{a.raw()} * of_b - std::int64_t{b.raw()} * of_a;
    static_assert(18 + 22 - 32 == kJacobianFraction + 3);
    return clamp_jacobian(lowered(static_cast<std::int32_t>(cross >> 32), 3));
  };
  vertex.jacobian[0] = about(arm[1], c.z, arm[2], c.y);
  vertex.jacobian[1] = about(arm[2], c.x, arm[0], c.z);
  vertex.jacobian[2] = about(arm[0], c.y, arm[1], c.x);
}

// A window's reach on the plate, by a 32-bit division: 0.1 % where 0.8 px are a millimetre.
Mm to_mm(Px px, Scale scale) {
  BERTH_RANGE(px.raw() >= 0 && px.raw() < 1 << 20 && scale.raw() >= 1 << 10);
  return Mm::from_raw(static_cast<std::int32_t>((static_cast<std::uint32_t>(px.raw()) << 12) /
                                                    static_cast<std::uint32_t>(scale.raw() >> 10) &
                                                0x7fffffffu));
}

Px to_px(Mm mm, Scale scale) {
  return Px::saturated(shift_round(std::int64_t{mm.raw()} * scale.raw(), 18 + 20 - 16));
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
                Scale scale) {
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
  const Vec3Mm arm = rotate(r, p.place);
  const Vec3Mm seen = arm + view.pose.translation_mm;
  if (seen[2].raw() <= 0) return vertex;
  const PointProjection projection = project_along_ray(*view.camera, seen);
  vertex.point_px = projection.pixel;

  ImageUnit normal;
  if (!normal_to(projection, turned(r, p.tangent_x, p.tangent_y), normal)) return vertex;
  Gradient c = gradient_of(projection, normal, seen[2].raw());
  const Direction white = turned(r, p.white_x, p.white_y);
  const std::int32_t rise = multiply_high(c.x, raised(white.x, 2)) +
                            multiply_high(c.y, raised(white.y, 2)) +
                            multiply_high(c.z, raised(white.z, 2));
  if (rise < 0) {
    normal = {-normal.x, -normal.y};
    c = {-c.x, -c.y, -c.z};
  }
  const Scale scale = Scale::from_raw(rise < 0 ? -rise : rise);
  if (scale.raw() < (1 << 10)) return vertex;
  vertex.normal_x = Q<16>::from_raw(lowered(normal.x, 12));
  vertex.normal_y = Q<16>::from_raw(lowered(normal.y, 12));
  fill_jacobian(view, c, arm, vertex);
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

// To the rounding of steps.
bool is_same(Angle a, Angle b) {
  constexpr std::int32_t kRounding = 64;
  return abs(a - b).raw() <= kRounding;
}

}  // namespace

void OutlineWalk::begin(const OutlinePiece& piece) {
  piece_ = &piece;
  index_ = 0;
  is_closed_ = goes_on_ = false;
  if (!piece.is_arc) return;
  at_ = sin_cos(piece.first_angle);
  step_ = sin_cos(piece.step_angle);
  const Angle extent = Angle::from_wide(std::int64_t{piece.step_angle.raw()} * piece.segments);
  is_closed_ = is_same(extent, kPi + kPi);
  if (is_closed_) return;
  for (const End& end : ends_) {
    if (end.radius_mm != piece.radius_mm || !is_same(end.angle, piece.first_angle)) continue;
    goes_on_ = true;
    first_ = end.vertex;
  }
  turn_ ^= 1;
  ends_[turn_].radius_mm = piece.radius_mm;
  ends_[turn_].angle = piece.first_angle + extent;
}

OutlineVertex OutlineWalk::next() {
  const OutlinePiece& piece = *piece_;
  const int index = index_++;
  const bool is_known = index == 0 ? goes_on_ : is_closed_ && index == piece.segments;
  const OutlineVertex vertex =
      is_known ? first_ : make_vertex(*view_, piece, point_of(piece, at_, index));
  if (!piece.is_arc) return vertex;
  if (is_closed_) {
    if (index == 0) first_ = vertex;
  } else if (index == piece.segments) {
    ends_[turn_].vertex = vertex;
  }
  const std::int64_t cos =
      std::int64_t{at_.cos.raw()} * step_.cos.raw() - std::int64_t{at_.sin.raw()} * step_.sin.raw();
  const std::int64_t sin =
      std::int64_t{at_.sin.raw()} * step_.cos.raw() + std::int64_t{at_.cos.raw()} * step_.sin.raw();
  at_ = {Unit::from_wide(shift_round(sin, 30)), Unit::from_wide(shift_round(cos, 30))};
  return vertex;
}

OutlineMiddle middle_of(const OutlineVertex& a, const OutlineVertex& b) {
  constexpr std::int32_t kOne = 1 << 16;
  // The mean of both, Q<30>.
  const std::int32_t x = raised(a.normal_x.raw() + b.normal_x.raw(), 13);
  const std::int32_t y = raised(a.normal_y.raw() + b.normal_y.raw(), 13);
  const std::int32_t square = lowered(multiply_high(x, x) + multiply_high(y, y), 12);
  // Up to 60 degrees; beyond lies no outline of ours.
  const std::int32_t short_of = square < kOne / 4 * 3 ? kOne / 4 : kOne - square;
  const std::int32_t second = (short_of * (short_of >> 2)) >> 14;  // s^2, Q<16>
  // 1 / sqrt(1 - s), and that times sin(t) / t for s = sin(t)^2: below 1.2.
  const std::int32_t to_unit = kOne + short_of / 2 + (3 * second) / 8;
  const std::int32_t to_mean = kOne + short_of / 3 + (29 * second) / 100;
  OutlineMiddle middle;
  middle.normal_x = Q<16>::from_raw(multiply_high(x, raised(to_unit, 2)));
  middle.normal_y = Q<16>::from_raw(multiply_high(y, raised(to_unit, 2)));
  for (int i = 0; i < 6; ++i) {
    const std::int32_t sum = a.jacobian[i] + b.jacobian[i];  // |sum| <= 2^16
    middle.jacobian[i] = multiply_high(raised(sum, 13), raised(to_mean, 2));
  }
  return middle;
}

void shift_along_normal(const std::int64_t (&step)[kOutlineUnknowns], OutlineVertex& vertex) {
  std::int64_t shift = 0;  // Q<35>, below 6 2^15 2^27
  for (int i = 0; i < 6; ++i) add_product(shift, vertex.jacobian[i], narrow<std::int32_t>(step[i]));
  const std::int32_t px = raised(narrow<std::int32_t>(shift_round(shift, 35 - 16)), 2);  // Q<18>
  const auto along = [px](Q<16> normal) {
    return Px::from_raw(multiply_high(px, raised(normal.raw(), 14)));
  };
  vertex.point_px[0] += along(vertex.normal_x);
  vertex.point_px[1] += along(vertex.normal_y);
}

}  // namespace berth
