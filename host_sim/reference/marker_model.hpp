// Where the markers of a target appear in the image, in double, by OpenCV's camera model.
//
// The image of a circle's centre is not the centre of its image: both quantities below are those of
// the projected outline. Area centroids belong to the distorted image, as intensities see them;
// conic centres to the ideal one (lens distortion removed, the same camera matrix), where a circle
// is an exact ellipse with dual conic H diag(1, 1, -1) H^T, H = K [R r e1, R r e2, R c + t].
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "host_sim/io/camera_model.hpp"
#include "host_sim/io/target_file.hpp"
#include "host_sim/reference/rigid.hpp"

namespace berth::host {

/// OpenCV's form of a camera: matrix 3 x 3, distortion 1 x 5, both of double.
cv::Mat1d camera_matrix(const Camera& camera);
cv::Mat1d distortion_row(const Camera& camera);

/// Pixels of the distorted image / of the ideal image.
std::vector<cv::Point2d> project_points(const Camera& camera, const Rigid& camera_from_target,
                                        const std::vector<cv::Point3d>& points_mm);
std::vector<cv::Point2d> ideal_points(const Camera& camera, const std::vector<cv::Point2d>& pixels);
Eigen::Vector2d project_ideal(const Camera& camera, const Rigid& camera_from_target,
                              const Eigen::Vector3d& point_mm);

/// Outlines in the target frame, counted from x towards y; a circle parallel to the plate.
std::vector<cv::Point3d> circle_outline(const Eigen::Vector3d& center_mm, double radius_mm,
                                        int points);
std::vector<cv::Point3d> bar_outline(const Line& line, int points_per_side);

/// A circle of the target; the disc's and the ring's edges are circles parallel to the plate.
struct Circle {
  Eigen::Vector3d center_mm = Eigen::Vector3d::Zero();
  double radius_mm = 0;
};

/// Centre of the ellipse that the circle's edge is in the ideal image.
Eigen::Vector2d conic_center(const Camera& camera, const Rigid& camera_from_target,
                             const Circle& circle);

struct AreaCentroid {
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  double area = 0;  ///< px^2, positive from x towards y
};

AreaCentroid polygon_centroid(const std::vector<cv::Point2d>& polygon);

/// Area centroids of a dot, of the ring's annulus and of the line in the distorted image.
Eigen::Vector2d dot_centroid(const Camera& camera, const Rigid& camera_from_target, const Dot& dot);
Eigen::Vector2d ring_centroid(const Camera& camera, const Rigid& camera_from_target,
                              const Ring& ring);
Eigen::Vector2d line_centroid(const Camera& camera, const Rigid& camera_from_target,
                              const Line& line);

}  // namespace berth::host
