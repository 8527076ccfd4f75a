// Stage 3: is this ring the target's, and which way is it turned?
//
// Wen et al. put a square boundary in a fixed proportion around each circle and look for the right
// number of straight lines inside, in the right place. Here the ring's ellipse gives the plate's
// pose up to roll and a two-fold tilt (ring_pose.hpp), so the boundary is put in perspective, and
// the right place is known to a few per cent:
//  1. Ring test: brighter than the plate on both sides in most directions.
//  2. Roll: grey levels on circles through the line's middle and through the dots are compared with
//     the layout for 72 rolls and both tilts.
//  3. Line test: across the line, at nine stations along it, both of its long edges must show, at
//     the right distance and on one straight line; beyond its ends there must be none. This
//     measures the roll.
// The layout check on the located dots (stage 5) has the last word.
#pragma once

#include "circle/ring_candidates.hpp"
#include "core/reason.hpp"
#include "core/work.hpp"
#include "image/search_grid.hpp"
#include "target/reference.hpp"
#include "target/ring_pose.hpp"

namespace berth {

struct Identification {
  Reason reason = Reason::kNoCircle;  // kNone: accepted
  RigidTransform camera_from_target;  // to a few per cent
  ReferenceValues reference;
  std::int32_t line_stations = 0;  // of kLineStations, where the line shows
  bool line_in_place = false;      // LineTest::in_place
  std::int32_t line_cost = 0;      // LineTest::cost, to choose between the two tilts
};

constexpr int kLineStations = 9;
constexpr int kMinLineStations = 4;  // half of the line may be hidden

/// Where the target is in the image.
struct RingImage {
  Vec2Px center_px{Px(0), Px(0)};
  Px radius_px;  // semi-major axis of the ring's outer edge: the radius over the distance
  Angle roll;    // of the target's x axis in the image, from u towards v
};
RingImage image_of_ring(const TargetView& view, const TargetModel& target);

/// Radius of the circle whose image `ring` is. Where smoothing with a sigma of s cells makes the
/// two edges of a band of half width h one, the outer one is seen further out: the extrema of g(x +
/// h) - g(x - h) lie at x with (x + h) / (x - h) = exp(2 x h / s^2), so x - h is 0.54 s at h = s /
/// 2, 0.2 s at s and 0.03 s at 1.5 s: 2/3 (1.3 s - h). The kernels and the binning have s = 1.05.
Mm apparent_radius(const TargetModel& target, const RingCandidate& ring);

/// The two plate poses of a ring. False when its outline is no circle's image, or `work` is spent.
bool solve_plates(const Camera& camera, const TargetModel& target, const SearchGrid& grid,
                  const RingCandidate& ring, PlatePose (&plates)[2], Work& work);

/// Judge one ring in one of its plate poses. `noise_q8` is the sensor noise in DN. Where `work` is
/// spent on the way the ring is not accepted. `has_roll`: the plate has the target's own, to some
/// degrees; where the line shows, it need not be searched for.
/// Cost: about 100 k instructions, of which the ring test takes 21 k and the roll search 55 k.
Identification identify_target(const Camera& camera, const ImageView& image, const PlatePose& plate,
                               const TargetModel& target, std::uint16_t noise_q8, Work& work,
                               bool has_roll = false);

}  // namespace berth
