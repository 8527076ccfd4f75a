// Things that look like the target and are not: what the chain must refuse.
//
// Each is the target's own description with one thing changed, or a plate with circles on it. CT-1
// is its own mirror image (its layout has the symmetry x -> -x, and a line on another side is a
// roll), so a mirrored CT-1 is CT-1 and no near miss; handedness is tested with another target.
#pragma once

#include <string>
#include <vector>

#include "host_sim/io/target_file.hpp"
#include "host_sim/render/random.hpp"
#include "host_sim/render/scene.hpp"

namespace berth::host {

enum class NearMissKind {
  kNoLine,        ///< ring and dots without a line
  kLineDistance,  ///< the line nearer to the ring or farther from it
  kLineTurned,    ///< the line about the ring's centre, between two quarters
  kLineSlanted,   ///< the line about its own centre
  kLineLength,
  kLineWidth,
  kRingRadius,  ///< outer and inner edge, the ring's width kept
  kRingWidth,   ///< the inner edge
  kDotDistance,
  kDotRadius,
  kNoDots,      ///< ring and line without a dot
  kRing,        ///< a ring on a plate
  kDisc,        ///< a disc on a plate
  kConcentric,  ///< machined circles
  kBackground,  ///< no plate at all
  kCount
};
inline constexpr int kNearMissKinds = static_cast<int>(NearMissKind::kCount);

/// Name in snake case, as it stands in frames.csv.
const char* near_miss_name(NearMissKind kind);

/// Whether `amount` has a meaning for this kind.
bool has_amount(NearMissKind kind);

/// The changed description. `amount`: relative change of the dimension (0.1: 10 % larger), radians
/// for kLineTurned and kLineSlanted.
Target near_miss_target(NearMissKind kind, const Target& target, double amount);

/// How far the change moves an outline on the plate, mm; 0 where `amount` has no meaning.
double near_miss_shift_mm(NearMissKind kind, const Target& target, double amount);

/// A change of at least a tenth, up to `most`, to both sides; 12 to 78 degrees for kLineTurned, 8
/// to 30 for kLineSlanted.
double draw_amount(NearMissKind kind, Random& random);

/// Machined circles on the plate of a scene: painted discs of falling radius and changing grey,
/// laid over the scene's own occluders.
std::vector<Occluder> concentric_circles(const Target& target, const Light& light, Random& random);

}  // namespace berth::host
