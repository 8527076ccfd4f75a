#include "pipeline/window.hpp"

#include "camera/projection.hpp"
#include "image/gradient_rows.hpp"

namespace berth {
namespace {

constexpr int kAlignment_px = 8;                         // rows begin at even words
constexpr int kMargin_px = 16;                           // borders of the grid, and the blur
constexpr int kLeastSide_px = 2 * (kMinGridWidth + 20);  // for the smallest plate, and borders

struct Interval {
  int from = 1 << 20, to = -(1 << 20);  // px

  void include(Px place) {
    const int at = place.floor();
    if (at < from) from = at;
    if (at > to) to = at;
  }
  int length() const { return to - from; }

  // Widened by `margin`, at least kLeastSide_px long, inside 0..size.
  Interval widened(int margin, int size) const {
    Interval wide{from - margin, to + margin};
    const int lacking = kLeastSide_px - wide.length();
    if (lacking > 0) wide = {wide.from - lacking / 2, wide.to + lacking};
    wide.from = wide.from < 0 ? 0 : wide.from / kAlignment_px * kAlignment_px;
    if (wide.to > size) wide.to = size;
    return wide;
  }
};

SearchGrid window(const Camera& camera, Interval x, Interval y) {
  const int margin = (x.length() > y.length() ? x.length() : y.length()) / 8 + kMargin_px;
  x = x.widened(margin, camera.width);
  y = y.widened(margin, camera.height);
  return SearchGrid{x.from, y.from, 2, x.length() / 2, y.length() / 2};
}

}  // namespace

SearchGrid window_around(const Camera& camera, const TargetModel& target,
                         const RigidTransform& camera_from_target) {
  const Mm half_width = Mm::from_raw(target.plate_width_mm.raw() / 2),
           half_height = Mm::from_raw(target.plate_height_mm.raw() / 2);
  Interval x, y;
  for (int corner = 0; corner < 4; ++corner) {
    const Vec3Mm place((corner & 1) != 0 ? half_width : -half_width,
                       (corner & 2) != 0 ? half_height : -half_height, Mm(0));
    const Vec3Mm seen = camera_from_target.rotation * place + camera_from_target.translation_mm;
    if (seen[2].raw() <= 0) return {0, 0, 2, camera.width / 2, camera.height / 2};
    const Vec2Px pixel = project(camera, seen);
    x.include(pixel[0]);
    y.include(pixel[1]);
  }
  return window(camera, x, y);
}

SearchGrid window_around(const Camera& camera, const SearchGrid& grid, const RingCandidate& ring) {
  Interval x, y;
  x.include(grid.to_frame_x(ring.ellipse.cx - ring.axes.half_width));
  x.include(grid.to_frame_x(ring.ellipse.cx + ring.axes.half_width));
  y.include(grid.to_frame_y(ring.ellipse.cy - ring.axes.half_height));
  y.include(grid.to_frame_y(ring.ellipse.cy + ring.axes.half_height));
  return window(camera, x, y);
}

}  // namespace berth
