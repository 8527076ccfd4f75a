// The ground truth of rendered frames as CSV.
#pragma once

#include <array>
#include <string>

#include "host_sim/render/scene.hpp"

namespace berth::host {

/// Hamilton quaternion (w, x, y, z) of a rotation matrix, w >= 0.
std::array<double, 4> quaternion_from_rotation(const Eigen::Matrix3d& R);

/// The column names, without a line end.
std::string truth_header();

/// One frame's row, without a line end; the pose fields are empty where the scene has no target.
std::string truth_row(const std::string& file, const Scene& scene);

}  // namespace berth::host
