// Validation of a camera: what projection.hpp may rely on after the parameter block is in.
//
// Accepted: 1 to 1024 pixels a side, focal lengths of 16 to 4096 px that differ by a factor of 2 at
// most, a principal point within two image sizes, |k| < 128 by format, |p| < 1/2, every
// ray of the image within kMaxRay, and a distortion that is invertible over the image: on a grid of
// 33 x 33 points, border included, the Jacobian's determinant stays above 1/16 and undistort()
// returns to the pixel within 2^-14 px.
#pragma once

#include "camera/camera.hpp"
#include "core/field_fault.hpp"

namespace berth {

/// The first field that is out of range, in the order of the struct; "camera.distortion" where the
/// coefficients together are not invertible. Any bit pattern is a legal input. Cost: 1 M
/// instructions, once.
FieldFault validate_camera(const Camera& camera);

}  // namespace berth
