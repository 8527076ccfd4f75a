// The cooperative target as data: ring, line, dots (frames as in docs/interfaces.md).
//
// Target frame: origin at the ring's centre on the plate's front face, x right, y down as seen by
// a camera facing an upright target, z into the plate. Lengths in mm. A raised dot has z < 0.
#pragma once

#include <cstdint>

#include "camera/camera.hpp"

namespace berth {

constexpr int kMaxDots = 8;

struct Dot {
  Vec3Mm center_mm{Mm(0), Mm(0), Mm(0)};
  Mm radius_mm;
  Mm collar_radius_mm;  // 0: no collar
  Mm post_radius_mm;    // 0: no post
};

struct TargetModel {
  Mm plate_width_mm, plate_height_mm;
  bool white_on_black = true;
  Mm ring_outer_mm, ring_inner_mm;
  Mm line_x_mm, line_y_mm;  // centre of the line, z = 0
  Mm line_length_mm, line_width_mm;
  Angle line_angle;  // of its long side from x towards y
  std::int32_t dot_count = 0;
  Dot dots[kMaxDots];  // dots[0] is D0, the raised one, if has_raised_dot()

  bool has_raised_dot() const { return dot_count > 0 && dots[0].center_mm[2].raw() != 0; }
};

}  // namespace berth
