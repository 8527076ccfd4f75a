// The OpenCV pipeline's pose beside ours.
#pragma once

#include <optional>

#include "host_sim/reference/reference.hpp"
#include "host_sim/report/frame_record.hpp"
#include "host_sim/report/truth.hpp"

namespace berth::host {

/// The sigma of a rotation or translation is the root of the trace of its 3 x 3 block.
struct ReferenceComparison {
  std::optional<DoublePose> pose;  // OpenCV's; nothing where it found none or was not asked
  double sigma_rotation_deg = 0;
  double sigma_translation_mm = 0;
  double residual_px = 0;
  // Differences to our pose and the combined sigma, where OpenCV has a pose and ours is valid.
  bool is_compared = false;
  double rotation_deg = 0;
  double translation_mm = 0;
  double combined_rotation_deg = 0;
  double combined_translation_mm = 0;

  /// Further apart than three of their combined sigma, in rotation or translation.
  bool disagrees() const {
    return is_compared && (rotation_deg > 3 * combined_rotation_deg ||
                           translation_mm > 3 * combined_translation_mm);
  }
};

ReferenceComparison compare_with_reference(const FrameRecord& record,
                                           const ReferencePose& reference);

}  // namespace berth::host
