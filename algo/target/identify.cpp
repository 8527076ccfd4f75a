#include "target/identify.hpp"

#include "fixed/roots.hpp"
#include "fixed/trigonometry.hpp"
#include "target/line_test.hpp"
#include "target/roll_search.hpp"

namespace berth {
namespace {

constexpr std::uint32_t kStepsForPlates = 70000, kStepsForReference = 23000;
constexpr std::uint32_t kStepsForRoll = 57000, kStepsPerStation = 2400;

// Sectors of 24 in which the ring must stand out: a quarter may be hidden, and a shadow or a glint
// may take two more; inside, the collar and D0 may take another six.
constexpr int kMinBrightSectors = 14;
constexpr int kMinHollowSectors = 11;

bool is_ring(const ReferenceValues& r, std::uint16_t noise_q8) {
  const Grey contrast = r.white - r.black;
  const Grey least = 2 * noise_q8 * kGreyOne / 256;  // medians of 24: a fifth of the noise each
  return contrast > least && r.bright_sectors >= kMinBrightSectors &&
         r.hollow_sectors >= kMinHollowSectors;
}

Angle image_roll(const TargetView& view, const TargetModel& target) {
  const Vec2Px a = view.pixel(-target.ring_outer_mm, Mm(0));
  const Vec2Px b = view.pixel(target.ring_outer_mm, Mm(0));
  return atan2((b[1] - a[1]).raw(), (b[0] - a[0]).raw());
}

}  // namespace

RingImage image_of_ring(const TargetView& view, const TargetModel& target) {
  const Mm z = view.camera_from_target.translation_mm[2];
  return {view.pixel(Mm(0), Mm(0)), mul<16>(div<24>(target.ring_outer_mm, z), view.camera.fx),
          image_roll(view, target)};
}

Mm apparent_radius(const TargetModel& target, const RingCandidate& ring) {
  const std::int64_t radius = (std::int64_t{ring.axes.major.raw()} + ring.axes.minor.raw()) / 2;
  const Mm width = target.ring_outer_mm - target.ring_inner_mm;
  const std::int64_t half_band = radius * width.raw() / (2 * target.ring_outer_mm.raw() + 1);
  const std::int64_t outwards = (q<16>(1.36).raw() - half_band) * 2 / 3;
  if (outwards <= 0 || radius <= outwards) return target.ring_outer_mm;
  return target.ring_outer_mm +
         Mm::from_wide(std::int64_t{target.ring_outer_mm.raw()} * outwards / (radius - outwards));
}

bool solve_plates(const Camera& camera, const TargetModel& target, const SearchGrid& grid,
                  const RingCandidate& ring, PlatePose (&plates)[2], Work& work) {
  return work.take(kStepsForPlates) &&
         solve_ring_pose(camera, grid, ring.ellipse, apparent_radius(target, ring), plates);
}

Identification identify_target(const Camera& camera, const ImageView& image, const PlatePose& plate,
                               const TargetModel& target, std::uint16_t noise_q8, Work& work,
                               bool has_roll) {
  Identification id;
  if (!work.take(kStepsForReference)) return id;
  TargetView view{camera, image, with_roll(plate, Unit(1), Unit(0))};
  id.reference = measure_reference(view, target);
  if (!is_ring(id.reference, noise_q8)) return id;
  id.reason = Reason::kNoLine;
  const auto look_for_line = [&] {
    const LineTest line = find_line(view, target, id.reference, noise_q8);
    work.spend(static_cast<std::uint32_t>(line.looks) * kStepsPerStation);
    return line;
  };
  Angle roll(0);
  LineTest line;
  if (has_roll) line = look_for_line();
  if (!line.is_line) {
    if (!work.take(kStepsForRoll)) return id;
    roll = search_roll(view, target, id.reference).angle;
    const SinCos turn = sin_cos(roll);
    view.camera_from_target = with_roll(plate, turn.cos, turn.sin);
    line = look_for_line();
  }
  if (!line.is_line) return id;
  id.reason = Reason::kNone;
  id.line_stations = line.stations;
  id.line_in_place = line.in_place;
  id.line_cost = line.cost;
  const SinCos corrected = sin_cos(roll + line.turn);
  id.camera_from_target = with_roll(plate, corrected.cos, corrected.sin);
  return id;
}

}  // namespace berth
