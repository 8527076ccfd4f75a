// Stage 5: dots located by region growing from their predicted places.
//
// For each dot: the brightest place near the prediction, local black and white around it, a region
// grown at their middle, its size and roundness compared with the dot's projection, and the
// centroid of grey over local black within an ellipse around it. A dot that is hidden, cut, merged
// with its neighbourhood or drowned by a glint is not located. The centroids start the pose; the
// outline refinement measures the same edges again, better.
#pragma once

#include "core/work.hpp"
#include "marker/marker.hpp"
#include "target/reference.hpp"

namespace berth {

/// Fill `markers` with all dots of the target (located or not), then ring and line as not located.
/// `view` is stage 3's pose, good to a few per cent. Dots that `work` does not afford are not
/// located. Cost: about 15 instructions per pixel of the windows (2.7 dot radii a side).
void locate_dots(const TargetView& view, const TargetModel& target,
                 const ReferenceValues& reference, std::uint16_t noise_q8, MarkerSet& markers,
                 Work& work);

}  // namespace berth
