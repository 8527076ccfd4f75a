#include "target/reference.hpp"

#include "fixed/trigonometry.hpp"

namespace berth {
namespace {

Grey median(Grey (&values)[kReferenceSectors]) {
  for (int i = 1; i < kReferenceSectors; ++i) {
    const Grey v = values[i];
    int k = i;
    for (; k > 0 && values[k - 1] > v; --k) values[k] = values[k - 1];
    values[k] = v;
  }
  return values[kReferenceSectors / 2];
}

Grey median_of(const Grey (&values)[kReferenceSectors]) {
  Grey sorted[kReferenceSectors];
  for (int i = 0; i < kReferenceSectors; ++i) sorted[i] = values[i];
  return median(sorted);
}

Mm part(Mm a, Mm b, int percent) {  // a + percent of (b - a)
  return Mm::from_wide(a.raw() + (std::int64_t{b.raw()} - a.raw()) * percent / 100);
}

}  // namespace

ReferenceValues measure_reference(const TargetView& view, const TargetModel& target) {
  ReferenceValues r;
  const Mm middle = part(target.ring_inner_mm, target.ring_outer_mm, 50);
  // Half a ring's width and a blur's reach away from the edges, clear of the line on the outside.
  const Mm width = target.ring_outer_mm - target.ring_inner_mm;
  const Mm outside = target.ring_outer_mm + width;
  const Mm inside = target.ring_inner_mm - width;
  Grey hollow[kReferenceSectors];
  for (int k = 0; k < kReferenceSectors; ++k) {
    const SinCos turn = sin_cos(part_of_turn(k, kReferenceSectors));
    r.sector_white[k] = view.at(middle * turn.cos, middle * turn.sin);
    r.sector_black[k] = view.at(outside * turn.cos, outside * turn.sin);
    hollow[k] = view.at(inside * turn.cos, inside * turn.sin);
  }
  r.white = median_of(r.sector_white);
  r.black = median_of(r.sector_black);
  const Grey contrast = r.white - r.black;
  if (contrast <= 0) return r;
  for (int k = 0; k < kReferenceSectors; ++k) {
    const Grey least = contrast / 4;  // a shadow that leaves 30 % of the light still counts
    if (r.sector_white[k] - hollow[k] > least) ++r.hollow_sectors;
    if (r.sector_white[k] >= 254 * kGreyOne) ++r.clipped_sectors;
    if (r.sector_white[k] - r.sector_black[k] > least) {
      ++r.bright_sectors;
    } else {
      r.sector_white[k] = r.white;
      r.sector_black[k] = r.black;
    }
  }
  return r;
}

int relative_level(const ReferenceValues& r, int sector, Grey grey) {
  if (grey == kNoGrey) return 0;
  const Grey black = r.sector_black[sector], white = r.sector_white[sector];
  const int level = (grey - black) * 256 / (white - black > 0 ? white - black : 1);
  return level < -128 ? -128 : (level > 384 ? 384 : level);
}

}  // namespace berth
