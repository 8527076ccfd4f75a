// Frames of the operating envelope: how far the poses lie off, whether their covariance says so,
// and how often an estimator at the Cramer-Rao bound would have been precise enough.
#pragma once

#include "accuracy/clean_campaign.hpp"
#include "accuracy/ledger.hpp"

namespace berth::accuracy {

/// One frame, refined from a start near the truth.
struct EnvelopeFrame {
  bool ok = false;
  double distance_mm = 0;
  double nees = 0;                              // e^T Sigma^-1 e over its expectation, 6
  double rotation_deg = 0, translation_mm = 0;  // errors
  double bound_deg = 0, bound_mm = 0;
  double precise_at_bound = 0;  // probability of a high-precision pose at the bound
  double bound_nees = 0;        // e^T Bound^-1 e / 6
  bool is_precise() const;
  /// Bound at most a third of both limits of a high-precision pose.
  bool is_well_conditioned() const;
};

/// Frame `index` of the sequence `seed`; nothing where the plate does not fit into the image.
std::vector<EnvelopeFrame> measure_envelope(const Rig& rig, std::uint64_t seed, int frames,
                                            Ledger& ledger);

/// What frames add up to.
struct EnvelopeSummary {
  int frames = 0, failed = 0, well_conditioned = 0;
  double nees = 0, nees_median = 0, covered = 0;  // of the frames with a result
  double precise = 0, precise_at_bound = 0;       // share of all
  double precise_well_conditioned = 0;
  double worst_rotation_deg = 0;
};
EnvelopeSummary summarise(const std::vector<EnvelopeFrame>& frames, double nearest_mm = 0,
                          double farthest_mm = 1e9);

}  // namespace berth::accuracy
