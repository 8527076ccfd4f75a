// Outlines of the target's parts, projected into the image.
#pragma once

#include "host_sim/io/camera_model.hpp"
#include "host_sim/io/target_file.hpp"
#include "host_sim/render/coverage.hpp"
#include "host_sim/render/scene.hpp"

namespace berth::host {

/// A camera looking at the target from one pose.
struct View {
  const Camera& camera;
  const Pose& pose;
};

/// p_C = R p_T + t.
Eigen::Vector3d camera_from_target(const Pose& pose, const Eigen::Vector3d& p_target_mm);

/// Pixel of a point in the target frame (mm).
Eigen::Vector2d project_point(const View& view, const Eigen::Vector3d& p_target_mm);

/// A circle parallel to the plate. The polygon's radius is such that its area is the circle's.
Polygon project_circle(const View& view, const Eigen::Vector3d& center_mm, double radius_mm);

/// A polygon at constant z, its sides subdivided, since distortion bends them.
Polygon project_polygon(const View& view, const std::vector<std::array<double, 2>>& corners_mm,
                        double z_mm);

/// The corners of a rectangle; the angle runs from x towards y.
std::vector<std::array<double, 2>> rectangle_corners(const std::array<double, 2>& center_mm,
                                                     double length_mm, double width_mm,
                                                     double angle_rad);

Polygon project_plate(const View& view, const Target& target);
Polygon project_line(const View& view, const Line& line);

/// The silhouette of a raised dot's post: the hull of its two end circles.
Polygon project_post(const View& view, const Dot& dot);

/// The convex hull of points, counter-clockwise in x right, y down turned over.
Polygon convex_hull(Polygon points);

/// Whether the whole target, raised dots included, lies on the image.
bool is_inside_image(const View& view, const Target& target);

}  // namespace berth::host
