// Division of the target's outlines into sectors, each with grey levels of its own.
//
// A sector is a dot, a sixteenth of the ring (both edges) or a quarter of the line (both long
// edges, at its ends the short one too). Inside a sector black and white are two unknowns, and a
// slope of the light that is common to the target; so shadows, gradients and stray light need no
// model. Both edges of ring and line share a sector because a common shift of the two is then
// uncorrelated with the levels.
#pragma once

#include <cstdint>

#include "pose/outline_geometry.hpp"

namespace berth {

constexpr int kRingSectors = 16;
constexpr int kLineSectors = 4;
constexpr int kMaxSectors = kMaxDots + kRingSectors + kLineSectors;
constexpr int kMaxPieces = 3;  // of a sector

constexpr int kDotSegments = 16, kCoarseDotSegments = 10;
constexpr int kCoarseRingVertices = 4, kCoarseLineVertices = 7;  // two edges, and the line's end
constexpr int kMaxCoarseVertices = kMaxDots * (kCoarseDotSegments + 1) +
                                   kRingSectors * kCoarseRingVertices +
                                   kLineSectors * kCoarseLineVertices;

struct OutlineSector {
  std::int32_t marker = 0;  // dots in the model's order, then ring, then line
  Mm center_x, center_y;
  std::int32_t count = 0;
  OutlinePiece pieces[kMaxPieces];
};

inline int sector_count(const TargetModel& target) {
  return target.dot_count + kRingSectors + kLineSectors;
}

/// Sectors first .. end - 1, in the order of all: those of dots, ring, line.
struct SectorRange {
  int first, end;
};
inline SectorRange dot_sectors(const TargetModel& target) { return {0, target.dot_count}; }
inline SectorRange ring_sectors(const TargetModel& target) {
  return {target.dot_count, target.dot_count + kRingSectors};
}
inline SectorRange line_sectors(const TargetModel& target) {
  return {target.dot_count + kRingSectors, sector_count(target)};
}

/// Marker of a sector without building it.
inline int sector_marker(const TargetModel& target, int sector) {
  if (sector < target.dot_count) return sector;
  return sector < target.dot_count + kRingSectors ? target.dot_count : target.dot_count + 1;
}

/// Place of a piece's first vertex among those of all long segments.
inline int coarse_vertex(const TargetModel& target, int sector, int piece) {
  if (sector < target.dot_count) return sector * (kCoarseDotSegments + 1);
  const int dots = target.dot_count * (kCoarseDotSegments + 1), of_ring = sector - target.dot_count;
  if (of_ring < kRingSectors) return dots + of_ring * kCoarseRingVertices + 2 * piece;
  return dots + kRingSectors * kCoarseRingVertices +
         (of_ring - kRingSectors) * kCoarseLineVertices + 2 * piece;
}

/// `corner_mm`: the length that blur takes from each end of a straight edge, for the choice of its
/// ends only.
struct LayoutScale {
  Mm corner_mm;
  bool is_coarse;  // three fifths of the segments, for poses a tenth of a pixel off
};

/// Of all outlines. At most 8 m.
Mm outline_length(const TargetModel& target);

/// Of all sectors.
int outline_segments(const TargetModel& target, bool is_coarse);

OutlineSector make_outline_sector(const TargetModel& target, int sector, const LayoutScale& scale);

}  // namespace berth
