// Why a frame gave no valid pose. One reason per frame; its name stands in CSV files and reports.
#pragma once

#include <cstdint>

namespace berth {

enum class Reason : std::uint8_t {
  kNone = 0,          // a valid pose
  kBadFrame,          // the image's size is not the camera's, or the frame could not be read
  kLowContrast,       // no gradient in the image stands out of its noise
  kNoCircle,          // edges, but no ellipse that could be the ring
  kNoLine,            // a ring, but no line at its place
  kLayoutMismatch,    // ring and line, but dots or proportions are not the target's
  kDotMissing,        // ring, line, and only two usable dots
  kSaturated,         // so much is clipped that nothing, or no layout, can be told
  kDegenerate,        // the usable dots are collinear or coincide: no minimal solution
  kNoSolution,        // P3P gave no pose that explains the markers
  kResidualTooLarge,  // a pose, but markers do not fit it within their noise
  kAmbiguous,         // two poses explain the markers almost equally well
  kImprecise,         // three sigma of the pose exceed the limits of a false pose
  kPoolFull,          // a pool filled up before the target was found
  kDeadline,          // the frame's work budget was spent before the target was found
  kCount
};

/// Name in snake case, as it stands in the poses CSV ("" for kNone). Cost: constant.
const char* reason_name(Reason reason);

}  // namespace berth
