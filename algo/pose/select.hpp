// Candidate poses from triples of dots: P3P on each, scored by all dots.
//
// Score: sum over the dots of min(|measured - predicted centroid|^2, T^2), so that one wrong dot
// costs every candidate the same and a triple without it wins. Poses from behind the plate are
// dropped. Triples come in the order of their worth: those with depth (the raised dot) by their
// longest side, then the others by theirs.
#pragma once

#include "pose/perspective_bias.hpp"

namespace berth {

/// A dot as the selection sees it.
struct DotObservation {
  std::uint8_t index = 0;  // in the model
  Vec3Mm center_mm;
  Vec2Px measured_px;
};

struct DotObservations {
  const TargetModel* target = nullptr;  // outlives this
  std::int32_t count = 0;
  DotObservation dot[kMaxDots];
};

struct SelectionLimits {
  std::int32_t min_triples = 4;               // tried in any case
  std::int32_t max_triples = 10;              // 1..56; CT-1 has 10
  Px settled_px = q<16>(0.5);                 // rms over the dots at which min_triples suffice
  Px outlier_px = Px(3);                      // T: up to 64
  Unit distinct_cosine = q<30>(0.999390827);  // of 2 deg: poses closer than that are one
};

struct Candidate {
  RigidTransform camera_from_target;
  std::int64_t score = 0;       // px^2, 32 fraction bits
  std::uint8_t triple[3] = {};  // places in DotObservations
};

constexpr int kMaxCandidates = 4;

struct CandidateList {
  Reason reason = Reason::kNoSolution;
  std::int32_t count = 0;
  std::int32_t solutions = 0;  // P3P poses tried
  std::int32_t triples = 0;
  Candidate best[kMaxCandidates];  // mutually distinct, best first
};

/// The located dots of `markers`.
void observe_dots(const TargetModel& target, const MarkerSet& markers, DotObservations& out);

/// kNone with at least one candidate; kDotMissing below three dots; kDegenerate when no triple is
/// usable; kNoSolution. Cost: about 150 000 instructions per triple.
void select_candidates(const Camera& camera, const DotObservations& dots,
                       const SelectionLimits& limits, CandidateList& out);

/// Inserts a pose into the list: scored, and kept if it is among the best distinct ones.
void offer_candidate(const Camera& camera, const DotObservations& dots,
                     const SelectionLimits& limits, const RigidTransform& pose,
                     const std::uint8_t (&triple)[3], CandidateList& list);

/// Are the rotations closer than the angle of this cosine?
bool is_same_rotation(const Mat3Unit& a, const Mat3Unit& b, Unit cosine);

}  // namespace berth
