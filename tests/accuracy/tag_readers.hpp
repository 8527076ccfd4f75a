// The tag readers of the comparison: libapriltag and OpenCV's ArUco with their best refinement.
#pragma once

#include <array>
#include <memory>
#include <optional>

#include "accuracy/tag_scene.hpp"

namespace berth::accuracy {

/// Corners of tag 0's black border in the image, clockwise from the upper left; pixel centres are
/// whole numbers.
using TagCorners = std::array<Eigen::Vector2d, 4>;

/// AprilTag 3 at full resolution with its edge refinement.
std::optional<TagCorners> read_apriltag(const host::Image8& image);

enum class ArucoRefinement { kSubpixel, kContour, kApriltag };
std::optional<TagCorners> read_aruco(const host::Image8& image, ArucoRefinement refinement);

/// The pose that minimises the corners' reprojection error. Of the two that a planar target allows
/// the one nearer to the truth: the comparison is about precision, not about ambiguity.
host::Pose pose_from_corners(const TagCorners& corners, const TagPattern& tag,
                             const host::Camera& camera, const host::Pose& truth);

}  // namespace berth::accuracy
