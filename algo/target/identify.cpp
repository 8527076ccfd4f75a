#include "target/identify.hpp"

#include "fixed/roots.hpp"
#include "fixed/trigonometry.hpp"
#include "target/line_test.hpp"
#include "target/roll_search.hpp"

namespace berth {
namespace {

// Sectors of 24 in which the ring must stand out: a quarter may be hidden, and a shadow or a glint
// may take two more; inside, the collar and D0 may take another six.
constexpr int kMinBrightSectors = 14;
constexpr int kMinHollowSectors = 11;
constexpr int kMinLineStations = 4;  // half of the line may be hidden

bool is_ring(const ReferenceValues& r, std::uint16_t noise_q8) {
  const Grey contrast = r.white - r.black;
  const Grey least = 5 * noise_q8 * kGreyOne / 256;
  return contrast > least && r.bright_sectors >= kMinBrightSectors &&
         r.hollow_sectors >= kMinHollowSectors;
}

Angle image_roll(const TargetView& view, const TargetModel& target) {
  const Vec2Px a = view.pixel(Vec3Mm(-target.ring_outer_mm, Mm(0), Mm(0)));
  const Vec2Px b = view.pixel(Vec3Mm(target.ring_outer_mm, Mm(0), Mm(0)));
  return atan2((b[1] - a[1]).raw(), (b[0] - a[0]).raw());
}

}  // namespace

Identification identify_target(const Camera& camera, const TargetModel& target,
                               const ImageView& image, const SearchGrid& grid,
                               const RingCandidate& ring, std::uint16_t noise_q8) {
  Identification best;
  PlatePose plates[2];
  if (!solve_ring_pose(camera, grid, ring.ellipse, target.ring_outer_mm, plates)) return best;
  for (const PlatePose& plate : plates) {
    TargetView view{camera, image, with_roll(plate, Unit(1), Unit(0))};
    const ReferenceValues reference = measure_reference(view, target);
    if (!is_ring(reference, noise_q8)) continue;
    if (best.reason == Reason::kNoCircle) best.reason = Reason::kNoLine;
    const RollScore roll = search_roll(view, target, reference);
    const SinCos turn = sin_cos(roll.angle);
    view.camera_from_target = with_roll(plate, turn.cos, turn.sin);
    const LineTest line = test_line(view, target, reference, roll.angle);
    if (!line.is_line || line.stations < kMinLineStations) continue;
    if (best.reason == Reason::kNone && line.cost >= best.score) continue;
    const SinCos corrected = sin_cos(roll.angle + line.turn);
    best.reason = Reason::kNone;
    best.camera_from_target = with_roll(plate, corrected.cos, corrected.sin);
    best.reference = reference;
    best.line_stations = line.stations;
    best.score = line.cost;
  }
  if (best.reason != Reason::kNone) return best;
  const TargetView view{camera, image, best.camera_from_target};
  best.ring_center_px = view.pixel(Vec3Mm(Mm(0), Mm(0), Mm(0)));
  best.ring_radius_px = Px::from_wide(std::int64_t{ring.axes.major.raw()} * grid.bin);
  best.roll = image_roll(view, target);
  return best;
}

}  // namespace berth
