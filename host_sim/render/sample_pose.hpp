// Poses of the operating envelope.
#pragma once

#include "host_sim/render/outline.hpp"

namespace berth::host {

/// The pose of a viewpoint: R = R_sight Rz(direction) Rx(tilt) Rz(-direction) Rz(roll), where
/// R_sight turns the optical axis to the line of sight by the shortest way.
Pose pose_from_viewpoint(const Viewpoint& viewpoint, const Camera& camera);

/// Draws the image position of the plate's centre, uniform given that the whole target lies in the
/// image; (u, v) in (0, 1) is the first candidate's place, later ones come from `seed`. Fills the
/// viewpoint's center_px; false where no place fits (the centre of the image stands in).
bool sample_position(double u, double v, uint64_t seed, const Camera& camera, const Target& target,
                     Viewpoint& viewpoint);

}  // namespace berth::host
