#include "edge/ridges.hpp"

namespace berth {
namespace {

constexpr Pair kBothLanes = 0x80008000u;

// Bit 15 of each lane: a >= b. Numbers below 32768.
constexpr Pair at_least(Pair a, Pair b) { return (a | kBothLanes) - b; }
constexpr Pair more_than(Pair a, Pair b) { return at_least(a, b) - both(1); }

struct Maxima {
  Pair in_x, in_y;  // bit 15 of each lane
};

// Those of the maxima that lie along an axis which counts.
Pair along_gradient(const GradientWord& here, const Maxima& maxima) {
  const Pair m = here.magnitude;
  const Pair twice_x = 2 * absolute_pair(here.gradient[0]);  // of |gx| + |gy|
  const Pair steep_in_x = at_least(twice_x, m);
  // ||gx| - |gy|| < m / 4: shares between 3/8 and 5/8.
  const Pair difference = absolute_pair(subtract_pairs(twice_x, m));
  const Pair diagonal = more_than(m >> 2 & both(0x3fff), difference);
  return ((maxima.in_x & (steep_in_x | diagonal)) | (maxima.in_y & (~steep_in_x | diagonal))) &
         kBothLanes;
}

}  // namespace

void find_ridges(const GradientRows& rows, int y, int words, int threshold, Ridges& ridges) {
  const GradientWord *const above = hidden(rows.row(y - 1)), *const here = hidden(rows.row(y)),
                            *const below = hidden(rows.row(y + 1));
  const Pair least = both(static_cast<std::uint32_t>(threshold));
  const Span<const std::uint16_t> strong = rows.strong(y);
  const std::uint16_t *at = strong.data(), *end = at + strong.size();
  while (at != end && *at < kGridBorder) ++at;
  while (at != end && end[-1] >= words - kGridBorder) --end;
  std::uint16_t *left = ridges.words[0], *right = ridges.words[1];
  for (; at != end; ++at) {
    const int k = *at;
    const GradientWord* const word = hidden(here + k);
    const Pair m = word->magnitude;
    const Pair to_reach = m | kBothLanes, to_exceed = hidden(to_reach - both(1));
    const Maxima either = {(to_exceed - word[-1].magnitude) & (to_reach - word[1].magnitude),
                           (to_exceed - above[k].magnitude) & (to_reach - below[k].magnitude)};
    const Pair candidates = (either.in_x | either.in_y) & (to_reach - least);
    if ((candidates & kBothLanes) == 0) continue;
    const Pair lanes = along_gradient(*word, either) & candidates;
    if ((lanes & 0x8000u) != 0) *left++ = static_cast<std::uint16_t>(k);
    if ((lanes >> 31) != 0) *right++ = static_cast<std::uint16_t>(k);
  }
  ridges.count[0] = static_cast<int>(left - ridges.words[0]);
  ridges.count[1] = static_cast<int>(right - ridges.words[1]);
}

}  // namespace berth
