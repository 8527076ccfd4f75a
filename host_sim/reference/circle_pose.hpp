// The two poses of a circle of known radius from its ellipse.
//
// The ellipse and the camera's centre span a cone x^T Q x = 0. With Q's eigenvalues
// l1 >= l2 > 0 > l3 and eigenvectors e1, e3, the planes that cut it in circles have the normals
//   n = s1 sqrt((l1 - l2) / (l1 - l3)) e1 + s3 sqrt((l2 - l3) / (l1 - l3)) e3,
// s1, s3 = +-1, and the circle of radius r in them lies at depth z0 = r l2 / sqrt(-l1 l3) along
// the known direction (Chen, Wu, Wada: Camera calibration with two arbitrary coplanar circles,
// ECCV 2004).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "host_sim/io/camera_model.hpp"
#include "host_sim/reference/blobs.hpp"

namespace berth::host {

struct CirclePose {
  Eigen::Vector3d center_mm;  ///< camera frame
  Eigen::Vector3d normal;     ///< unit, away from the camera: the target's z axis
};

/// One or two poses; none where the ellipse is no image of a circle in front of the camera.
std::vector<CirclePose> circle_poses(const Camera& camera, const cv::RotatedRect& ellipse,
                                     double radius_mm);

}  // namespace berth::host
