// P3P in double by another method than algo/'s: Grunert's quartic (Haralick et al., IJCV 1994),
// roots as eigenvalues of the companion matrix, then Newton steps in long double.
#pragma once

#include <vector>

#include "scenes.hpp"

namespace berth::test {

/// All poses, double roots as pairs; bearings are unit vectors.
std::vector<PoseD> solve_grunert(const Eigen::Vector3d (&bearing)[3],
                                 const Eigen::Vector3d (&point_mm)[3]);

/// The solution nearest to a pose, by Newton steps from that pose's own distances. False when they
/// don't converge.
bool refine_distances(const Eigen::Vector3d (&bearing)[3], const Eigen::Vector3d (&point_mm)[3],
                      const PoseD& start, PoseD& out);

}  // namespace berth::test
