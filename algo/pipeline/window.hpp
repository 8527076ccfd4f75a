// Where to search when the last frame's pose is known: the target's surroundings.
#pragma once

#include "camera/camera.hpp"
#include "camera/rigid_transform.hpp"
#include "circle/ring_candidates.hpp"
#include "image/search_grid.hpp"
#include "target/model.hpp"

namespace berth {

/// The plate's image under `camera_from_target`, widened on each side by an eighth of its larger
/// side and 16 px, binned 2 x 2 and cut at the frame. An eighth of a plate is 15 mm: 120 mm/s
/// across the line of sight at eight frames per second, and more than distance and tilt change in a
/// frame. The whole frame where a corner would lie behind the camera. Cost: about 1500
/// instructions.
SearchGrid window_around(const Camera& camera, const TargetModel& target,
                         const RigidTransform& camera_from_target);

/// The same around a ring's outline in `grid`.
SearchGrid window_around(const Camera& camera, const SearchGrid& grid, const RingCandidate& ring);

}  // namespace berth
