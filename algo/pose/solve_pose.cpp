// See solve_pose.hpp.
#include "pose/solve_pose.hpp"

#include "fixed/scaled.hpp"
#include "pose/frames.hpp"
#include "pose/scaled_vector.hpp"

namespace berth {
namespace {

constexpr int kMaxRefined = 3;
constexpr std::int32_t kTrialIterations = 4;
constexpr std::uint32_t kStepsPerTriple = 113000;
constexpr std::uint32_t kStepsToRefine = 6000, kStepsPerIteration = 14500, kStepsPerResidual = 5000;
constexpr std::uint32_t kStepsToReport = 60000;

/// A candidate scored above this can't become nearly as good as the best one: refinement over all
/// dots reduces the rms of a pose through three of them by much less than 16, of the best one too.
std::int64_t plausible_score(std::int64_t best) {
  constexpr std::int64_t kFloor = (std::int64_t{1} << 32) / 80;  // 5 dots of 0.05 px
  return (best + kFloor) * 256;
}

/// The pose seen as its mirror image through the plane across the line of sight.
[[gnu::noinline]] RigidTransform mirrored(const RigidTransform& pose) {
  const ScaledVector v = unit(scaled_vector(pose.translation_mm));
  const Scaled along[3] = {v.x, v.y, v.z};
  RigidTransform out = pose;
  for (int k = 0; k < 3; ++k) {
    const ScaledVector column = {Scaled(pose.rotation(0, k)), Scaled(pose.rotation(1, k)),
                                 Scaled(pose.rotation(2, k))};
    const Scaled twice = dot(column, v).times_power_of_two(1);
    const Scaled entry[3] = {column.x, column.y, column.z};
    for (int i = 0; i < 3; ++i) {
      const Scaled reflected = entry[i] - twice * along[i];
      out.rotation(i, k) = (k == 2 ? -reflected : reflected).to<30>();
    }
  }
  return out;
}

class Solver {
 public:
  Solver(const Camera& camera, const TargetModel& target, MarkerSet& markers,
         const PoseLimits& limits, const RigidTransform* guess, PoseOutcome& outcome, Work& work)
      : camera_(camera),
        target_(target),
        markers_(markers),
        limits_(limits),
        guess_(guess),
        outcome_(outcome),
        work_(work) {}

  void run() {
    CandidateList candidates;
    weigh_markers(markers_, weighted_);
    outcome_.reason = propose(candidates);
    if (outcome_.reason != Reason::kNone) return;
    refine_all(candidates);
    if (!best_.ok) {
      outcome_.reason = Reason::kNoSolution;
      return;
    }
    if (!is_consistent(best_)) leave_one_out(candidates);
    work_.spend(kStepsToReport);
    report();
  }

 private:
  [[gnu::noinline]] Reason propose(CandidateList& candidates) {
    DotObservations dots;
    observe_dots(target_, markers_, dots);
    if (!propose_guess(dots, candidates)) {
      select_candidates(camera_, dots, limits_.selection, candidates);
      outcome_.candidates = candidates.solutions;
      work_.spend(static_cast<std::uint32_t>(candidates.triples) * kStepsPerTriple);
    }
    if (candidates.reason == Reason::kNone) {
      offer(dots, mirrored(candidates.best[0].camera_from_target), candidates);
    }
    return candidates.reason;
  }

  /// The minimum beside the guess, where there are more than three dots: it and its mirror image
  /// are what triples would lead to, and where a dot is wrong, what all but one start from.
  bool propose_guess(const DotObservations& dots, CandidateList& candidates) {
    if (!guess_ || dots.count <= 3) return false;
    near_ = refine(*guess_);
    if (!near_.ok) return false;
    offer(dots, near_.camera_from_target, candidates);
    if (candidates.count == 0) return false;  // it shows the plate's back
    candidates.reason = Reason::kNone;
    return true;
  }

  void offer(const DotObservations& dots, const RigidTransform& pose,
             CandidateList& candidates) const {
    const std::uint8_t none[3] = {};
    offer_candidate(camera_, dots, limits_.selection, pose, none, candidates);
  }

  Refined refine(const RigidTransform& start, std::int32_t iterations = kMaxIterations) {
    if (work_.is_spent()) return {};
    const Refined refined = refine_centroids(camera_, target_, weighted_, start, iterations);
    outcome_.iterations += refined.iterations;
    // The start is evaluated, and each step but one that is known to be the last.
    const int evaluations = refined.iterations + (refined.is_determined ? 0 : 1);
    work_.spend(kStepsToRefine +
                static_cast<std::uint32_t>(refined.iterations) * kStepsPerIteration +
                static_cast<std::uint32_t>(evaluations * weighted_.used) * kStepsPerResidual);
    return refined;
  }

  bool is_distinct(const RigidTransform& a, const RigidTransform& b) const {
    return !is_same_rotation(a.rotation, b.rotation, limits_.selection.distinct_cosine);
  }
  bool is_distinct(const Refined& a, const Refined& b) const {
    return is_distinct(a.camera_from_target, b.camera_from_target);
  }

  bool is_consistent(const Refined& refined) const {
    return whitened_residual(weighted_, refined) <= limits_.residual_sigmas;
  }

  /// Within a quarter of the limit beyond it: a few steps bring the sum that near to its minimum.
  bool is_nearly_consistent(const Refined& refined) const {
    const std::int64_t limit = limits_.residual_sigmas.raw();
    return refined.ok && whitened_residual(weighted_, refined).raw() <= limit + limit / 4;
  }

  /// Best and the best distinct second of the first candidates' minima. The one beside the guess is
  /// a minimum, as long as all markers are in use.
  void refine_all(const CandidateList& candidates) {
    best_ = second_ = Refined{};
    const std::int64_t plausible = plausible_score(candidates.best[0].score);
    for (int i = 0; i < candidates.count && i < kMaxRefined; ++i) {
      if (candidates.best[i].score > plausible) break;
      const RigidTransform& start = candidates.best[i].camera_from_target;
      const bool is_near = near_.ok && weighted_.used == weighted_.count &&
                           !is_distinct(near_.camera_from_target, start);
      keep(is_near ? near_ : refine(start));
    }
  }

  void keep(const Refined& found) {
    if (!found.ok) return;
    if (!best_.ok || found.cost < best_.cost) {
      if (best_.ok && is_distinct(best_, found)) second_ = best_;
      if (second_.ok && !is_distinct(second_, found)) second_ = Refined{};
      best_ = found;
    } else if (is_distinct(best_, found) && (!second_.ok || found.cost < second_.cost)) {
      second_ = found;
    }
  }

  /// From the minima of all markers to those of the ones in use: a few steps tell whether these
  /// agree. What lay in one basin with all of them may lie in two without one: then from the
  /// candidates.
  void refine_again(const Refined& all_best, const Refined& all_second,
                    const CandidateList& candidates) {
    best_ = second_ = Refined{};
    for (const Refined* start : {&all_best, &all_second}) {
      if (!start->ok) continue;
      const Refined near = refine(start->camera_from_target, kTrialIterations);
      if (is_nearly_consistent(near)) keep(refine(near.camera_from_target));
    }
    if (best_.ok && !all_second.ok) refine_all(candidates);
  }

  /// Looks for the one marker without which the others agree: needs two degrees of freedom left.
  [[gnu::noinline]] void leave_one_out(const CandidateList& candidates) {
    if (weighted_.count < 5) return;
    const Refined all_best = best_, all_second = second_;
    Refined found, rival;
    int wrong = -1;
    for (int m = 0; m < weighted_.count; ++m) {
      set_used(m, false);
      refine_again(all_best, all_second, candidates);
      if (best_.ok && is_consistent(best_)) {
        if (wrong < 0 || best_.cost < found.cost) {
          if (wrong >= 0) rival = found;
          if (second_.ok && is_consistent(second_)) rival = second_;
          found = best_;
          wrong = m;
        } else if (!rival.ok || best_.cost < rival.cost) {
          rival = best_;
        }
      }
      set_used(m, true);
    }
    best_ = all_best;
    second_ = all_second;
    if (wrong < 0) return;
    set_used(wrong, false);
    best_ = found;
    second_ = rival.ok && is_distinct(found, rival) ? rival : Refined{};
    outcome_.left_out = weighted_.marker[wrong].source;
  }

  void set_used(int m, bool used) {
    WeightedMarker& marker = weighted_.marker[m];
    if (marker.used != used) weighted_.used += used ? 1 : -1;
    marker.used = used;
  }

  [[gnu::noinline]] void report() {
    PoseEstimate& estimate = outcome_.estimate;
    estimate.camera_from_target = best_.camera_from_target;
    estimate.residual_px = residual_px(weighted_, best_);
    estimate.markers_used = weighted_.used;
    outcome_.whitened_residual = whitened_residual(weighted_, best_);
    report_second(estimate);
    report_markers();
    outcome_.has_pose = true;
    if (!is_determined()) {
      outcome_.reason = Reason::kDegenerate;
    } else if (!is_consistent(best_)) {
      outcome_.reason = Reason::kResidualTooLarge;
    } else if (is_ambiguous(estimate)) {
      outcome_.reason = Reason::kAmbiguous;
    }
  }

  bool is_determined() const {
    PoseCovariance covariance;
    return best_.is_determined ||
           centroid_covariance(camera_, target_, weighted_, best_.camera_from_target, covariance);
  }

  /// Too alike in residual, or too near in likelihood for these variances.
  bool is_ambiguous(const PoseEstimate& estimate) const {
    if (!estimate.has_second) return false;
    if (estimate.ambiguity > limits_.ambiguity_ratio) return true;
    const Scaled sigma(weighted_.unit_sigma_px);
    return Scaled::from_raw(second_.cost - best_.cost, 36) <
           Scaled(limits_.ambiguity_chi2) * sigma * sigma;
  }

  void report_second(PoseEstimate& estimate) const {
    estimate.has_second = second_.ok;
    estimate.ambiguity = Unit(0);
    if (!second_.ok) return;
    estimate.second = second_.camera_from_target;
    estimate.second_residual_px = residual_px(weighted_, second_);
    // Without redundancy every pose fits: nothing tells them apart.
    const bool is_told_apart = best_.freedom > 0 && second_.cost > best_.cost;
    estimate.ambiguity =
        is_told_apart
            ? sqrt(Scaled::from_raw(best_.cost, 36) / Scaled::from_raw(second_.cost, 36)).to<30>()
            : Unit(1);
  }

  void report_markers() {
    for (int i = 0; i < markers_.count; ++i) markers_.markers[i].used = false;
    for (int m = 0; m < weighted_.count; ++m) {
      const WeightedMarker& weighted = weighted_.marker[m];
      Marker& marker = markers_.markers[weighted.source];
      marker.used = weighted.used;
      const MarkerNodes nodes = nodes_of(target_, weighted.kind, weighted.index);
      Vec2Px predicted, center;
      if (!predict_centroid(camera_, best_.camera_from_target, nodes, predicted)) continue;
      if (!project_center(camera_, best_.camera_from_target, nodes, center)) continue;
      marker.bias_px = {Px::saturated(std::int64_t{predicted[0].raw()} - center[0].raw()),
                        Px::saturated(std::int64_t{predicted[1].raw()} - center[1].raw())};
    }
  }

  const Camera& camera_;
  const TargetModel& target_;
  MarkerSet& markers_;
  const PoseLimits& limits_;
  const RigidTransform* guess_;
  PoseOutcome& outcome_;
  Work& work_;
  WeightedMarkers weighted_;
  Refined near_;  // the minimum beside the guess
  Refined best_, second_;
};

}  // namespace

PoseOutcome solve_pose(const Camera& camera, const TargetModel& target, MarkerSet& markers,
                       const PoseLimits& limits, Work& work, const RigidTransform* guess) {
  PoseOutcome outcome;
  Solver(camera, target, markers, limits, guess, outcome, work).run();
  return outcome;
}

bool find_covariance(const Camera& camera, const TargetModel& target, const MarkerSet& markers,
                     PoseEstimate& estimate) {
  WeightedMarkers weighted;
  weigh_markers(markers, weighted);
  for (int m = 0; m < weighted.count; ++m) {
    WeightedMarker& marker = weighted.marker[m];
    marker.used = markers.markers[marker.source].used;
    if (!marker.used) --weighted.used;
  }
  return centroid_covariance(camera, target, weighted, estimate.camera_from_target,
                             estimate.covariance);
}

}  // namespace berth
