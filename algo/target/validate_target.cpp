#include "target/validate_target.hpp"

#include "fixed/trigonometry.hpp"

namespace berth {
namespace {

// Distances and areas are judged in 1/256 mm: differences stay below 2^18, squares below 2^36,
// sums of three below 2^38, the product with a small factor below 2^42, all of it in 64 bits.
using Coarse = Q<8>;

struct Offset {
  std::int64_t x, y, z;  // 1/256 mm, below 2^18 for points on or before a legal plate
};

Offset offset(const Vec3Mm& a, const Vec3Mm& b) {
  const auto axis = [&](int i) {
    return std::int64_t{a[i].to<8>().raw()} - std::int64_t{b[i].to<8>().raw()};
  };
  return {axis(0), axis(1), axis(2)};
}

std::int64_t squared(const Offset& d) { return d.x * d.x + d.y * d.y + d.z * d.z; }

std::int64_t squared(Mm length) {
  const std::int64_t coarse = length.to<8>().raw();
  return coarse * coarse;
}

std::int64_t magnitude(std::int64_t value) { return value < 0 ? -value : value; }

template <int F>
bool is_within(Q<F> value, Q<F> low, Q<F> high) {
  return value >= low && value <= high;
}

/// Twice the plate's half side, so that no half of an odd raw value is lost.
bool is_on_plate(Mm center, Mm reach, Mm side) {
  return is_within(center, -side, side) && is_within(reach, Mm(0), side) &&
         abs(center) + abs(center) + reach + reach <= side;
}

FieldFault check_plate(const TargetModel& t) {
  if (!is_within(t.plate_width_mm, kMinPlateSide, kMaxPlateSide)) return {"target.plate_width_mm"};
  if (!is_within(t.plate_height_mm, kMinPlateSide, kMaxPlateSide)) {
    return {"target.plate_height_mm"};
  }
  return {};
}

FieldFault check_ring(const TargetModel& t) {
  const Mm side = t.plate_width_mm < t.plate_height_mm ? t.plate_width_mm : t.plate_height_mm;
  if (!is_within(t.ring_outer_mm, kMinMarkerSize, kMaxPlateSide) ||
      !is_on_plate(Mm(0), t.ring_outer_mm, side)) {
    return {"target.ring_outer_mm"};
  }
  if (!is_within(t.ring_inner_mm, kMinMarkerSize, kMaxPlateSide) ||
      t.ring_outer_mm - t.ring_inner_mm < kMinMarkerSize) {
    return {"target.ring_inner_mm"};
  }
  return {};
}

/// The bar's corners on the plate, and the bar clear of the ring. Its sizes are in range.
FieldFault check_line_place(const TargetModel& t) {
  const SinCos turn = sin_cos(t.line_angle);
  const Mm half_length = t.line_length_mm * q<30>(0.5);
  const Mm half_width = t.line_width_mm * q<30>(0.5);
  const Mm reach_x = half_length * abs(turn.cos) + half_width * abs(turn.sin);
  const Mm reach_y = half_length * abs(turn.sin) + half_width * abs(turn.cos);
  // A bar that touches the plate's border may lose a step of 2^-18 mm to rounding.
  const Mm slack = Mm::from_raw(8);
  if (!is_on_plate(t.line_x_mm, reach_x, t.plate_width_mm + slack) ||
      !is_on_plate(t.line_y_mm, reach_y, t.plate_height_mm + slack)) {
    return {"target.line_length_mm"};
  }
  // The ring's centre in the bar's axes; beyond the bar's half sides it is outside by so much.
  const Mm along = abs(t.line_x_mm * turn.cos + t.line_y_mm * turn.sin) - half_length;
  const Mm across = abs(t.line_y_mm * turn.cos - t.line_x_mm * turn.sin) - half_width;
  const std::int64_t outside =
      (along > Mm(0) ? squared(along) : 0) + (across > Mm(0) ? squared(across) : 0);
  return outside < squared(t.ring_outer_mm) ? FieldFault{"target.line_center_mm"} : FieldFault{};
}

FieldFault check_line(const TargetModel& t) {
  if (!is_on_plate(t.line_x_mm, kMinMarkerSize, t.plate_width_mm)) return {"target.line_x_mm"};
  if (!is_on_plate(t.line_y_mm, kMinMarkerSize, t.plate_height_mm)) return {"target.line_y_mm"};
  if (!is_within(t.line_length_mm, kMinMarkerSize, kMaxPlateSide)) {
    return {"target.line_length_mm"};
  }
  if (!is_within(t.line_width_mm, kMinMarkerSize, t.line_length_mm) ||
      t.line_width_mm == t.line_length_mm) {
    return {"target.line_width_mm"};
  }
  if (!is_within(t.line_angle, -kPi, kPi)) return {"target.line_angle"};
  return check_line_place(t);
}

/// A flat dot is clear of the ring: inside or outside, never across.
bool is_clear_of_ring(const TargetModel& t, const Dot& dot) {
  const Offset d = offset(dot.center_mm, Vec3Mm(Mm(0), Mm(0), Mm(0)));
  const std::int64_t distance_squared = squared(d);
  if (distance_squared >= squared(t.ring_outer_mm + dot.radius_mm)) return true;
  return dot.radius_mm < t.ring_inner_mm &&
         distance_squared <= squared(t.ring_inner_mm - dot.radius_mm);
}

FieldFault check_dot_size(const TargetModel& t, std::int32_t i) {
  const Dot& dot = t.dots[i];
  if (!is_within(dot.radius_mm, kMinMarkerSize, kMaxPlateSide)) {
    return {"target.dots[].radius_mm", i};
  }
  const bool has_collar = dot.collar_radius_mm != Mm(0);
  if (has_collar && !is_within(dot.collar_radius_mm, dot.radius_mm, kMaxPlateSide)) {
    return {"target.dots[].collar_radius_mm", i};
  }
  const Mm head = has_collar ? dot.collar_radius_mm : dot.radius_mm;
  if (!is_within(dot.post_radius_mm, Mm(0), head)) return {"target.dots[].post_radius_mm", i};
  return {};
}

FieldFault check_dot_place(const TargetModel& t, std::int32_t i) {
  const Dot& dot = t.dots[i];
  if (!is_on_plate(dot.center_mm[0], dot.radius_mm, t.plate_width_mm)) {
    return {"target.dots[].x_mm", i};
  }
  if (!is_on_plate(dot.center_mm[1], dot.radius_mm, t.plate_height_mm)) {
    return {"target.dots[].y_mm", i};
  }
  const Mm lowest = i == 0 ? -t.plate_width_mm : Mm(0);
  if (!is_within(dot.center_mm[2], lowest, Mm(0))) return {"target.dots[].z_mm", i};
  if (dot.center_mm[2] == Mm(0) && !is_clear_of_ring(t, dot)) {
    return {"target.dots[].center_mm", i};
  }
  return {};
}

FieldFault check_dot_distinct(const TargetModel& t, std::int32_t i) {
  for (std::int32_t j = 0; j < i; ++j) {
    const Mm reach = t.dots[i].radius_mm + t.dots[j].radius_mm;
    if (squared(offset(t.dots[i].center_mm, t.dots[j].center_mm)) < squared(reach)) {
      return {"target.dots[].center_mm", i};
    }
  }
  return {};
}

/// Twice the area of the triangle against the square of its first side: at least 1 : 16.
bool is_triangle(const Vec3Mm& a, const Vec3Mm& b, const Vec3Mm& c) {
  const Offset u = offset(b, a);
  const Offset v = offset(c, a);
  const std::int64_t area = magnitude(u.y * v.z - u.z * v.y) + magnitude(u.z * v.x - u.x * v.z) +
                            magnitude(u.x * v.y - u.y * v.x);
  return 16 * area >= squared(u) && 16 * area >= squared(v);
}

bool has_triangle(const TargetModel& t) {
  for (std::int32_t a = 0; a < t.dot_count; ++a) {
    for (std::int32_t b = a + 1; b < t.dot_count; ++b) {
      for (std::int32_t c = b + 1; c < t.dot_count; ++c) {
        if (is_triangle(t.dots[a].center_mm, t.dots[b].center_mm, t.dots[c].center_mm)) {
          return true;
        }
      }
    }
  }
  return false;
}

}  // namespace

FieldFault validate_target(const TargetModel& target) {
  for (const auto check : {check_plate, check_ring, check_line}) {
    const FieldFault fault = check(target);
    if (fault.is_fault()) return fault;
  }
  if (target.dot_count < kMinDots || target.dot_count > kMaxDots) return {"target.dot_count"};
  for (std::int32_t i = 0; i < target.dot_count; ++i) {
    for (const auto check : {check_dot_size, check_dot_place, check_dot_distinct}) {
      const FieldFault fault = check(target, i);
      if (fault.is_fault()) return fault;
    }
  }
  if (!has_triangle(target)) return {"target.dots"};
  return {};
}

}  // namespace berth
