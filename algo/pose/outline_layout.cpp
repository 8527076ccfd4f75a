#include "pose/outline_layout.hpp"

#include "fixed/roots.hpp"
#include "fixed/trigonometry.hpp"

namespace berth {
namespace {

Mm least(Mm a, Mm b) { return a < b ? a : b; }
Mm distance(Mm x, Mm y) { return Mm::saturated(hypot(x.raw(), y.raw())); }
Mm half(Mm a) { return Mm::from_raw(a.raw() / 2); }
Angle full_turn_over(int n) { return Angle::from_wide((2 * std::int64_t{kPi.raw()} + n / 2) / n); }

// Free black around a place of the plate with the given radius, to the plate's border.
Mm gap_to_border(const TargetModel& target, Mm x, Mm y, Mm radius) {
  return least(half(target.plate_width_mm) - abs(x), half(target.plate_height_mm) - abs(y)) -
         radius;
}

OutlineSector dot_sector(const TargetModel& target, int index, const LayoutScale& scale) {
  const Dot& dot = target.dots[index];
  OutlineSector sector;
  sector.marker = index;
  sector.center_x = dot.center_mm[0];
  sector.center_y = dot.center_mm[1];
  sector.count = 1;
  OutlinePiece& p = sector.pieces[0];
  p.origin = dot.center_mm;
  p.radius_mm = dot.radius_mm;
  p.segments = scale.is_coarse ? kCoarseDotSegments : kDotSegments;
  p.step_angle = full_turn_over(p.segments);
  p.size = OutlineSize::kDotRadius;
  p.width_mm = dot.radius_mm + dot.radius_mm;
  p.opposite_curvature = 1;
  const Mm from_center = distance(dot.center_mm[0], dot.center_mm[1]);
  if (dot.center_mm[2].raw() != 0) {
    p.raised = static_cast<std::int8_t>(index);
    p.clearance_mm = target.ring_inner_mm - from_center - dot.radius_mm;
  } else {
    const Mm to_ring = abs(from_center - target.ring_outer_mm) - dot.radius_mm;
    p.clearance_mm =
        least(gap_to_border(target, dot.center_mm[0], dot.center_mm[1], dot.radius_mm), to_ring);
  }
  return sector;
}

OutlineSector ring_sector(const TargetModel& target, int index, const LayoutScale& scale) {
  OutlineSector sector;
  sector.marker = target.dot_count;
  sector.count = 2;
  const Mm middle = half(target.ring_outer_mm + target.ring_inner_mm);
  const Angle extent = full_turn_over(kRingSectors);
  const Angle first = Angle::from_wide(std::int64_t{extent.raw()} * index);
  const SinCos at = sin_cos(first + Angle::from_raw(extent.raw() / 2));
  sector.center_x = middle * at.cos;
  sector.center_y = middle * at.sin;
  const int segments = scale.is_coarse ? 1 : 2;
  for (int i = 0; i < 2; ++i) {
    OutlinePiece& p = sector.pieces[i];
    p.is_hole = i == 1;
    p.size = i == 1 ? OutlineSize::kRingInner : OutlineSize::kRingOuter;
    p.radius_mm = i == 1 ? target.ring_inner_mm : target.ring_outer_mm;
    p.first_angle = first;
    p.segments = segments;
    p.step_angle = Angle::from_raw(extent.raw() / segments);
    p.width_mm = target.ring_outer_mm - target.ring_inner_mm;
    p.opposite_curvature = -1;
    p.clearance_mm =
        i == 1 ? target.ring_inner_mm : gap_to_border(target, Mm(0), Mm(0), target.ring_outer_mm);
  }
  // The line beside the ring.
  const Mm to_line = distance(target.line_x_mm, target.line_y_mm) - half(target.line_width_mm) -
                     target.ring_outer_mm;
  sector.pieces[0].clearance_mm = least(sector.pieces[0].clearance_mm, to_line);
  return sector;
}

// A straight piece from centre + along * u0 + across * v0, `length` in the direction (dx, dy).
OutlinePiece straight_piece(Mm x, Mm y, Unit dx, Unit dy, Mm length, int segments) {
  OutlinePiece p;
  p.is_arc = false;
  p.origin = Vec3Mm(x, y, Mm(0));
  p.along_x = dx;
  p.along_y = dy;
  p.segments = segments;
  const Mm step = Mm::from_raw(length.raw() / segments);
  p.step_x_mm = step * dx;
  p.step_y_mm = step * dy;
  return p;
}

OutlineSector line_sector(const TargetModel& target, int index, const LayoutScale& scale) {
  OutlineSector sector;
  sector.marker = target.dot_count + 1;
  const SinCos a = sin_cos(target.line_angle);
  const Unit ux = a.cos, uy = a.sin;  // along; across is (-uy, ux)
  const Mm half_length = half(target.line_length_mm), half_width = half(target.line_width_mm);
  const Mm usable = half_length + half_length - scale.corner_mm - scale.corner_mm;
  if (usable < half_length) return sector;  // blurred beyond use
  const Mm part = Mm::from_raw(usable.raw() / kLineSectors);
  const Mm begin = Mm::from_wide(std::int64_t{part.raw()} * index) - half(usable);
  const auto place_x = [&](Mm u, Mm v) { return target.line_x_mm + u * ux - v * uy; };
  const auto place_y = [&](Mm u, Mm v) { return target.line_y_mm + u * uy + v * ux; };
  sector.center_x = place_x(begin + half(part), Mm(0));
  sector.center_y = place_y(begin + half(part), Mm(0));
  const int segments = scale.is_coarse ? 1 : 2;
  const Mm clearance =
      least(gap_to_border(target, target.line_x_mm, target.line_y_mm, half_width),
            distance(target.line_x_mm, target.line_y_mm) - half_width - target.ring_outer_mm);
  sector.pieces[0] = straight_piece(place_x(begin, -half_width), place_y(begin, -half_width), ux,
                                    uy, part, segments);
  sector.pieces[1] = straight_piece(place_x(begin + part, half_width),
                                    place_y(begin + part, half_width), -ux, -uy, part, segments);
  sector.count = 2;
  const Mm short_usable = target.line_width_mm - scale.corner_mm - scale.corner_mm;
  const bool is_end = index == 0 || index == kLineSectors - 1;
  if (is_end && short_usable.raw() > target.line_width_mm.raw() / 8) {
    const Mm v = half(short_usable);
    sector.pieces[2] = index == 0
                           ? straight_piece(place_x(-half_length, v), place_y(-half_length, v), uy,
                                            -ux, short_usable, 2)
                           : straight_piece(place_x(half_length, -v), place_y(half_length, -v), -uy,
                                            ux, short_usable, 2);
    sector.count = 3;
  }
  const OutlineSize half_of_line =
      2 * index < kLineSectors ? OutlineSize::kFirstWidth : OutlineSize::kSecondWidth;
  for (int i = 0; i < sector.count; ++i) {
    if (i < 2) sector.pieces[i].size = half_of_line;
    sector.pieces[i].width_mm = i < 2 ? target.line_width_mm : target.line_length_mm;
    sector.pieces[i].clearance_mm = clearance;
  }
  return sector;
}

}  // namespace

Mm outline_length(const TargetModel& target) {
  Mm round = target.ring_outer_mm + target.ring_inner_mm;  // below 16 plates
  for (int d = 0; d < target.dot_count; ++d) round += target.dots[d].radius_mm;
  return Mm::saturated(
      2 * (kPi.to<18>().raw() * std::int64_t{round.raw()} >> 18) +
      2 * (std::int64_t{target.line_length_mm.raw()} + target.line_width_mm.raw()));
}

int outline_segments(const TargetModel& target, bool is_coarse) {
  constexpr int kEdges = 2, kEnds = 2;
  const int each = is_coarse ? 1 : 2;
  return target.dot_count * (is_coarse ? kCoarseDotSegments : kDotSegments) +
         (kRingSectors + kLineSectors) * kEdges * each + kEnds * 2;
}

OutlineSector make_outline_sector(const TargetModel& target, int sector, const LayoutScale& scale) {
  if (sector < target.dot_count) return dot_sector(target, sector, scale);
  sector -= target.dot_count;
  if (sector < kRingSectors) return ring_sector(target, sector, scale);
  return line_sector(target, sector - kRingSectors, scale);
}

}  // namespace berth
