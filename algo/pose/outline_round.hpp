// One round of the refinement over all outlines: every sector is measured, and those that show
// their markers in even light are kept for the equations.
#pragma once

#include <cstdint>

#include "fixed/linear.hpp"
#include "pose/outline.hpp"

namespace berth {

/// Every stride-th scan line, long segments while the pose is still coarse, and whether a station
/// that is displaced is an outlier.
struct OutlineRound {
  std::int32_t stride;
  bool is_coarse;
  bool judge_shift;
};

/// What the rounds know, each from the one before.
struct OutlineState {
  const OutlineInput& input;
  OutlineWorkspace& workspace;
  RigidTransform pose;
  ImageBlur blur;
  EdgeOffset edge_offset;
  std::int32_t ordinary_q8 = 0;  // mean squared residual of most sectors, DN^2
  SpdSystem<kOutlineUnknowns> system;
  std::uint32_t steps = 0;        // work so far
  std::int32_t explained_q8 = 0;  // what the last step takes off the mean square
  OutlineStep last{};             // the last step
  bool is_followed = true;        // by levels and light
  std::int64_t shift_square = 0;  // mean square of how far it moved the outlines, px^2 Q<20>
  BlurChange blur_change{};       // by the last round that measured it
  bool is_late = false;           // a round that was needed did not fit
  bool is_second_fit = false;     // the first one refused nearly all
  std::int64_t blur_growth = 0;
  Px traced_reach{0};  // for which the workspace's long segments were projected; 0: none
};

inline int sectors_of(const OutlineState& state) { return sector_count(state.input.target); }

/// v within -limit .. limit.
inline std::int64_t clamp_to(std::int64_t v, std::int64_t limit) {
  return v > limit ? limit : (v < -limit ? -limit : v);
}

/// Noise where the scale ends: the sensor's, and what rounding adds, one sigma, DN Q<8>.
std::int32_t scale_noise(std::int32_t noise_q8);

/// So near to an end of the scale that pixels of this level are censored.
bool is_censored(const OutlineState& state, const SectorLevel& level);

/// White or black beyond the scale's end, by `part` of the contrast, in more than half of the
/// sectors: their outlines are where the end of the scale puts them.
bool is_clipped(const OutlineState& state, int part, SectorRange sectors);
bool is_clipped(const OutlineState& state, int part);  // of all

/// Length of all outlines, were they square to the camera: whole px.
std::int64_t outline_px(const OutlineState& state);

/// Work of a round, more than it takes.
std::uint32_t most_steps_of(const OutlineState& state, const OutlineRound& round);

/// What more scan lines would change of it, nothing notices.
inline bool measures_blur(const OutlineState& state, const OutlineRound& round) {
  return round.is_coarse || !state.blur_change.is_slight;
}

/// Fills the workspace's `used`, `shares` and, where it is measured, `blur` from the image, and
/// counts the work.
void measure_outlines(OutlineState& state, const OutlineRound& round);

}  // namespace berth
