// See select.hpp.
#include "pose/select.hpp"

#include "fixed/scaled.hpp"
#include "pose/p3p.hpp"

namespace berth {
namespace {

/// Unit vector along (x, y, 1).
Vec3Unit bearing_of(const Vec2Ray& ray) {
  const Scaled x(ray[0]), y(ray[1]), one(1);
  const Scaled inverse = one / sqrt(x * x + y * y + one);
  return {(x * inverse).to<30>(), (y * inverse).to<30>(), inverse.to<30>()};
}

/// mm^2, 4 fraction bits, clamped below 2^30.
std::int32_t squared_distance(const Vec3Mm& a, const Vec3Mm& b) {
  std::int64_t sum = 0;  // Q32 of lengths below 2^14 mm: below 2^62
  for (int i = 0; i < 3; ++i) {
    const std::int64_t d = shift_round(std::int64_t{a[i].raw()} - b[i].raw(), 2);  // Q16
    sum += d * d;
  }
  constexpr std::int64_t kLargest = (std::int64_t{1} << 30) - 1;
  const std::int64_t squared = shift_round(sum, 28);
  return static_cast<std::int32_t>(squared < kLargest ? squared : kLargest);
}

/// Worth of a triple: its longest side squared; more than any flat one's with depth.
std::int32_t worth_of(const DotObservations& dots, int i, int j, int k) {
  const Vec3Mm& a = dots.dot[i].center_mm;
  const Vec3Mm& b = dots.dot[j].center_mm;
  const Vec3Mm& c = dots.dot[k].center_mm;
  const std::int32_t ab = squared_distance(a, b), ac = squared_distance(a, c);
  const std::int32_t bc = squared_distance(b, c);
  std::int32_t longest = ab > ac ? ab : ac;
  if (bc > longest) longest = bc;
  const bool has_depth = a[2] != b[2] || b[2] != c[2];
  return has_depth ? longest + (std::int32_t{1} << 30) : longest;
}

struct Triple {
  std::int32_t worth;
  std::uint8_t index[3];
};

constexpr int kMaxTriples = 56;  // 8 choose 3

int list_triples(const DotObservations& dots, Triple (&triples)[kMaxTriples]) {
  int count = 0;
  for (int i = 0; i < dots.count; ++i) {
    for (int j = i + 1; j < dots.count; ++j) {
      for (int k = j + 1; k < dots.count; ++k) {
        triples[count++] = {worth_of(dots, i, j, k),
                            {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(j),
                             static_cast<std::uint8_t>(k)}};
      }
    }
  }
  return count;
}

/// Moves the worthiest of the triples from `first` on to `first`; ties by order of listing.
void pull_worthiest(Triple (&triples)[kMaxTriples], int first, int count) {
  int best = first;
  for (int i = first + 1; i < count; ++i) {
    if (triples[i].worth > triples[best].worth) best = i;
  }
  const Triple pulled = triples[best];
  for (int i = best; i > first; --i) triples[i] = triples[i - 1];
  triples[first] = pulled;
}

/// Is the plate's front turned to the camera? The outward normal is -R e_z: R e_z . t > 0.
bool is_facing_camera(const RigidTransform& pose) {
  std::int64_t sum = 0;  // 3 * 2^60
  for (int i = 0; i < 3; ++i) {
    sum += std::int64_t{pose.rotation(i, 2).raw()} * (pose.translation_mm[i].raw() / 2);
  }
  return sum > 0;
}

/// False when a dot is not in front of the camera.
bool score_pose(const Camera& camera, const DotObservations& dots, const RigidTransform& pose,
                Px outlier, std::int64_t& score) {
  const std::int64_t limit = std::int64_t{outlier.raw()} * outlier.raw();
  score = 0;
  for (int i = 0; i < dots.count; ++i) {
    const DotObservation& dot = dots.dot[i];
    const MarkerNodes nodes = nodes_of(*dots.target, MarkerKind::kDot, dot.index);
    Vec2Px predicted;
    if (!predict_centroid_roughly(camera, pose, nodes, predicted)) return false;
    std::int64_t squared = 0;
    for (int k = 0; k < 2; ++k) {
      const std::int64_t d =
          saturate32(std::int64_t{dot.measured_px[k].raw()} - predicted[k].raw()) / 2;
      squared += d * d;  // quarter of the square: below 2^61
    }
    score += squared < limit / 4 ? squared * 4 : limit;
  }
  return true;
}

/// Does the best candidate explain the dots well enough to stop?
bool is_settled(const DotObservations& dots, const SelectionLimits& limits,
                const CandidateList& list) {
  const std::int64_t per_dot = std::int64_t{limits.settled_px.raw()} * limits.settled_px.raw();
  return list.count > 0 && list.best[0].score <= per_dot * dots.count;
}

}  // namespace

bool is_same_rotation(const Mat3Unit& a, const Mat3Unit& b, Unit cosine) {
  std::int64_t trace = 0;  // of A^T B = 1 + 2 cos, Q58 by halving twice: below 9 * 2^58
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      trace += shift_round(std::int64_t{a(i, k).raw()} * b(i, k).raw(), 2);
    }
  }
  return trace > (std::int64_t{1} << 58) + (std::int64_t{cosine.raw()} << 29);
}

void observe_dots(const TargetModel& target, const MarkerSet& markers, DotObservations& out) {
  out.target = &target;
  out.count = 0;
  for (int i = 0; i < markers.count; ++i) {
    const Marker& marker = markers.markers[i];
    if (marker.kind != MarkerKind::kDot || !marker.located || out.count == kMaxDots) continue;
    DotObservation& dot = out.dot[out.count++];
    dot.index = marker.index;
    dot.center_mm = target.dots[marker.index].center_mm;
    dot.measured_px = marker.center_px;
  }
}

void offer_candidate(const Camera& camera, const DotObservations& dots,
                     const SelectionLimits& limits, const RigidTransform& pose,
                     const std::uint8_t (&triple)[3], CandidateList& list) {
  Candidate candidate;
  candidate.camera_from_target = pose;
  for (int i = 0; i < 3; ++i) candidate.triple[i] = triple[i];
  if (!is_facing_camera(pose)) return;
  if (!score_pose(camera, dots, pose, limits.outlier_px, candidate.score)) return;
  // Equal or worse than a pose of the same kind: dropped. Better: it replaces them.
  int kept = 0;
  for (int i = 0; i < list.count; ++i) {
    const Candidate& other = list.best[i];
    if (is_same_rotation(other.camera_from_target.rotation, pose.rotation,
                         limits.distinct_cosine)) {
      if (other.score <= candidate.score) return;
      continue;
    }
    if (kept != i) list.best[kept] = other;
    ++kept;
  }
  list.count = kept;
  if (list.count == kMaxCandidates) {
    if (list.best[list.count - 1].score <= candidate.score) return;
    --list.count;
  }
  int place = list.count++;
  for (; place > 0 && list.best[place - 1].score > candidate.score; --place) {
    list.best[place] = list.best[place - 1];
  }
  list.best[place] = candidate;
}

void select_candidates(const Camera& camera, const DotObservations& dots,
                       const SelectionLimits& limits, CandidateList& out) {
  out = CandidateList{};
  if (dots.count < 3) {
    out.reason = Reason::kDotMissing;
    return;
  }
  Vec3Unit bearing[kMaxDots];
  for (int i = 0; i < dots.count; ++i) {
    bearing[i] = bearing_of(undistort(camera, dots.dot[i].measured_px));
  }
  Triple triples[kMaxTriples];
  const int count = list_triples(dots, triples);
  bool is_degenerate = true;
  for (int n = 0; n < count && out.triples < limits.max_triples; ++n) {
    pull_worthiest(triples, n, count);
    if (out.triples >= limits.min_triples && is_settled(dots, limits, out)) break;
    PointTriple points;
    for (int i = 0; i < 3; ++i) {
      points.bearing[i] = bearing[triples[n].index[i]];
      points.point_mm[i] = dots.dot[triples[n].index[i]].center_mm;
    }
    const P3pResult poses = solve_p3p(points);
    if (poses.reason == Reason::kDegenerate) continue;
    is_degenerate = false;
    ++out.triples;
    out.solutions += poses.count;
    for (int i = 0; i < poses.count; ++i) {
      offer_candidate(camera, dots, limits, poses.camera_from_target[i], triples[n].index, out);
    }
  }
  out.reason =
      out.count > 0 ? Reason::kNone : (is_degenerate ? Reason::kDegenerate : Reason::kNoSolution);
}

}  // namespace berth
