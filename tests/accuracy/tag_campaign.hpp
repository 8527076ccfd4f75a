// The whole chain against fiducial tags on the same plate: same poses, same light, same renderer.
#pragma once

#include "accuracy/clean_campaign.hpp"
#include "accuracy/ledger.hpp"

namespace berth::accuracy {

/// One reader of the comparison over one band of tilt and one distance.
struct ReaderScore {
  const char* name = "";
  int images = 0, missed = 0;
  double rotation_deg = 0, translation_mm = 0;                 // rms
  double rotation_over_bound = 0, translation_over_bound = 0;  // each against its own target's
};

struct TiltBand {
  double from_deg, to_deg;
};

/// Ours, AprilTag 3, ArUco with sub-pixel and with AprilTag refinement, in this order; clean
/// images. Tag readers take edges as straight: give them a camera without distortion. An image that
/// a reader misses counts in `missed` only.
std::vector<ReaderScore> compare_readers(const Rig& rig, const TiltBand& tilt, double distance_mm,
                                         int images, Ledger& ledger);

}  // namespace berth::accuracy
