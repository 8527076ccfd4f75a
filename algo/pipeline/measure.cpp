#include "pipeline/measure.hpp"

#include "core/digest.hpp"
#include "fixed/roots.hpp"
#include "fixed/trigonometry.hpp"
#include "pose/frames.hpp"

namespace berth {
namespace {

constexpr int kMinOutlines = 4;  // of dots, ring and line

// Against centroids that do not fit one another: five outlines, or four that fit as the noise has
// it; and their edges within half a pixel, or the outlines have caught on something else.
constexpr int kOverrulingOutlines = 5;
constexpr Q<16> kFittingSigmas = q<16>(1.25);
constexpr Px kFittingPx = q<16>(0.5);

constexpr std::uint32_t kStepsForCovariance = 60000;

void add_pose(const RigidTransform& t, Digest& digest) {
  for (int k = 0; k < 9; ++k) digest.add_signed(t.rotation(k / 3, k % 3).raw());
  for (int k = 0; k < 3; ++k) digest.add_signed(t.translation_mm[k].raw());
}

std::uint32_t digest_of(const PoseOutcome& outcome) {
  Digest digest;
  digest.add(static_cast<std::uint32_t>(outcome.reason));
  digest.add_signed(outcome.candidates);
  add_pose(outcome.estimate.camera_from_target, digest);
  add_pose(outcome.estimate.second, digest);
  return digest.value();
}

std::uint32_t digest_of(const OutlineResult& refined) {
  Digest digest;
  digest.add(static_cast<std::uint32_t>(refined.reason));
  add_pose(refined.pose, digest);
  for (int k = 0; k < 3; ++k) {
    digest.add_signed(refined.covariance.sigma_rotation[k].raw());
    digest.add_signed(refined.covariance.sigma_translation_mm[k].raw());
  }
  digest.add_signed(refined.stations);
  return digest.value();
}

// Three times the root of the sum of three squared sigmas, in the sigmas' format.
std::int64_t three_sigma(const std::int32_t (&sigma)[3]) {
  std::uint64_t sum = 0;
  for (const std::int32_t s : sigma) {
    sum +=
        static_cast<std::uint64_t>(std::int64_t{s} * s) >> 2;  // three squares of 2^62 would wrap
  }
  return 3 * 2 * std::int64_t{isqrt(sum)};
}

bool is_precise(const Thresholds& thresholds, const RigidTransform& pose,
                const PoseCovariance& covariance) {
  std::int32_t rotation[3], translation[3];
  for (int k = 0; k < 3; ++k) {
    rotation[k] = covariance.sigma_rotation[k].raw();
    translation[k] = covariance.sigma_translation_mm[k].raw();
  }
  const std::int64_t distance = hypot(
      static_cast<std::int32_t>(hypot(pose.translation_mm[0].raw(), pose.translation_mm[1].raw())),
      pose.translation_mm[2].raw());
  const std::int64_t limit = shift_round(distance * thresholds.false_translation.raw(), 24);
  return three_sigma(rotation) < thresholds.false_rotation.raw() &&
         three_sigma(translation) < limit;
}

void transfer_to_tool(const Parameters& parameters, FrameResult& result) {
  const FrameChain chain{parameters.effector_from_camera, result.pose.camera_from_target,
                         parameters.target_from_latch};
  ChainCovariance covariance;
  covariance.camera_from_target = &result.pose.covariance;
  result.effector_from_latch = effector_from_latch(chain);
  result.effector_covariance = transport_covariance(chain, covariance);
}

int popcount(std::uint16_t bits) {
  int count = 0;
  for (; bits != 0; bits = static_cast<std::uint16_t>(bits & (bits - 1))) ++count;
  return count;
}

void mark_used(std::uint16_t used, FrameResult& result) {
  result.pose.markers_used = 0;
  for (int m = 0; m < result.markers.count; ++m) {
    result.markers.markers[m].used = (used >> m & 1) != 0;
    if (result.markers.markers[m].used) ++result.pose.markers_used;
  }
}

// Four outlines, with ring or line among them: an occluder may pass for the dot that it hides, but
// then the pose that follows it loses ring and line.
bool is_usable(const OutlineResult& refined, const TargetModel& target) {
  const std::uint32_t ring_and_line = 3u << target.dot_count;
  return refined.reason == Reason::kNone && popcount(refined.markers_used) >= kMinOutlines &&
         (refined.markers_used & ring_and_line) != 0;
}

// Centroids on their own: every dot that was located must fit.
bool do_all_dots_fit(const MarkerSet& markers) {
  for (int m = 0; m < markers.count; ++m) {
    if (markers.markers[m].located && !markers.markers[m].used) return false;
  }
  return true;
}

// Is it a near miss, as the outlines see it? Where centroids don't agree, there is no pose to be
// saved, and outlines that fit nowhere are enough.
bool is_refuted(const OutlineResult& refined, const PoseOutcome& start) {
  return refined.has_wrong_size ||
         (start.reason == Reason::kResidualTooLarge && refined.reason != Reason::kNone);
}

bool do_overrule(const OutlineResult& refined) {
  return refined.residual_px < kFittingPx &&
         (popcount(refined.markers_used) >= kOverrulingOutlines ||
          refined.residual_sigmas < kFittingSigmas);
}

// Does `a` explain the outlines clearly better than `b`? The sums of squared grey residuals over
// their variance differ by five sigma of a chi-squared with the stations' freedom, or `b` fails.
bool is_clearly_better(const OutlineResult& a, const OutlineResult& b, const TargetModel& target) {
  if (!is_usable(a, target)) return false;
  if (!is_usable(b, target)) return true;
  const std::int64_t ra = a.residual_sigmas.raw(), rb = b.residual_sigmas.raw();
  const std::int64_t excess = shift_round(rb * rb - ra * ra, 16);  // of the mean square, 16 bits
  const std::int64_t mean = shift_round(ra * ra, 16) + 1;
  return excess * a.stations > 25 * mean;
}

// The outlines of ring, line and dots see perspective where centroids do not: refine the second
// pose too. The better one goes to `refined`; true when the other is clearly worse or the same
// pose.
bool is_settled_by_outlines(OutlineInput input, const PoseEstimate& estimate, Workspace& work,
                            Work& budget, OutlineResult& refined) {
  input.start = estimate.second;
  input.most_steps = budget.left();
  OutlineResult other;
  refine_outlines(input, work.outline, other);
  budget.spend(other.steps);
  if (other.reason == Reason::kDeadline) return false;
  constexpr Unit kHalfDegree = q<30>(0.99996192);
  if (is_usable(refined, input.target) && is_usable(other, input.target) &&
      is_same_rotation(refined.pose.rotation, other.pose.rotation, kHalfDegree)) {
    return true;
  }
  if (is_clearly_better(refined, other, input.target)) return true;
  if (!is_clearly_better(other, refined, input.target)) return false;
  refined = other;
  return true;
}

}  // namespace

PoseOutcome solve_from_dots(const Parameters& parameters, const RigidTransform& guess,
                            FrameResult& result, Work& budget) {
  PoseLimits limits;
  limits.residual_sigmas = parameters.thresholds.residual_sigmas;
  limits.ambiguity_ratio = parameters.thresholds.ambiguity_ratio;
  const PoseOutcome outcome =
      solve_pose(parameters.camera, parameters.target, result.markers, limits, budget, &guess);
  result.tally.pose_candidates = static_cast<std::uint16_t>(outcome.candidates);
  result.digests[static_cast<int>(Stage::kPose)] = digest_of(outcome);
  result.has_pose = outcome.has_pose;
  result.pose = outcome.estimate;
  return outcome;
}

void refine_from_outlines(const Parameters& parameters, const ImageView& image,
                          const PoseOutcome& start, const StartBlur& blur, Workspace& work,
                          FrameResult& result, Work& budget) {
  const OutlineInput input{parameters.camera,
                           parameters.target,
                           image,
                           start.estimate.camera_from_target,
                           result.tally.black,
                           result.tally.white,
                           result.tally.noise_q8,
                           blur.sigma_mm,
                           blur.last,
                           budget.left()};
  OutlineResult refined;
  refine_outlines(input, work.outline, refined);
  budget.spend(refined.steps);
  const auto keep_centroids = [&] {
    budget.spend(kStepsForCovariance);
    find_covariance(parameters.camera, parameters.target, result.markers, result.pose);
  };
  if (refined.reason == Reason::kDeadline) {
    result.reason = Reason::kDeadline;
    keep_centroids();
    transfer_to_tool(parameters, result);
    return;
  }
  bool is_ambiguous = start.reason == Reason::kAmbiguous;
  if (is_ambiguous && start.estimate.has_second) {
    is_ambiguous = !is_settled_by_outlines(input, start.estimate, work, budget, refined);
  }
  result.digests[static_cast<int>(Stage::kRefine)] = digest_of(refined);
  if (refined.reason == Reason::kNone) result.blur = refined.blur;
  if (is_refuted(refined, start)) {
    result.identified = false;
    result.reason = start.reason;
    return;
  }
  result.reason = start.reason;
  // Too few undisturbed outlines: the pose of the centroids stands, with its own covariance. Enough
  // of them overrule what a shadow's edge or a glint did to a centroid.
  const bool overrules = start.reason != Reason::kResidualTooLarge || do_overrule(refined);
  if (is_usable(refined, parameters.target) && overrules) {
    result.reason = is_ambiguous ? Reason::kAmbiguous : Reason::kNone;
    result.pose.camera_from_target = refined.pose;
    result.pose.covariance = refined.covariance;
    result.pose.residual_px = refined.residual_px;
    mark_used(refined.markers_used, result);
  } else {
    keep_centroids();
    if (result.reason == Reason::kNone && !do_all_dots_fit(result.markers)) {
      result.reason = Reason::kResidualTooLarge;
    }
  }
  if (result.reason == Reason::kNone &&
      !is_precise(parameters.thresholds, result.pose.camera_from_target, result.pose.covariance)) {
    result.reason = Reason::kImprecise;
  }
  transfer_to_tool(parameters, result);
  result.valid = result.reason == Reason::kNone;
}

}  // namespace berth
