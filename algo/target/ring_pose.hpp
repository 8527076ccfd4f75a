// Where a circle of known radius is, from the ellipse in which it appears: two poses.
//
// The viewing cone x^T C x = 0 of the ellipse has eigenvalues l1 >= l2 > 0 > l3 and eigenvectors
// e1, e2, e3 (Forsyth et al. 1991; Chen, Wu, Wada 2004). With s = +-1 the plane's normal and the
// circle's centre are
//   n = s h e1 + g e3,           h = sqrt((l1 - l2) / (l1 - l3)), g = sqrt((l2 - l3) / (l1 - l3))
//   c = R (-s h sqrt(-l3 / l1) e1 + g sqrt(l1 / -l3) e3)
// with e3 turned so that c lies in front of the camera. The roll about n stays unknown.
#pragma once

#include "camera/camera.hpp"
#include "camera/rigid_transform.hpp"
#include "circle/ellipse.hpp"
#include "image/search_grid.hpp"

namespace berth {

/// Pose of the plate up to its roll: columns of `basis` are u, v in the plate and n into it.
struct PlatePose {
  Mat3Unit basis = Mat3Unit::Identity();
  Vec3Mm center_mm{Mm(0), Mm(0), Mm(0)};
};

/// Both plate poses of a circle of radius `radius_mm` seen as `ellipse`. Distortion is removed from
/// 16 points of the outline. False when they are no ellipse or the circle lies out of range.
/// Cost: about 63 k instructions.
bool solve_ring_pose(const Camera& camera, const SearchGrid& grid, const Ellipse& ellipse,
                     Mm radius_mm, PlatePose (&poses)[2]);

/// The plate pose turned by a roll (cosine, sine): camera_from_target.
RigidTransform with_roll(const PlatePose& plate, Unit cosine, Unit sine);

}  // namespace berth
