// The surface that carries the target, seen by a camera without distortion.
//
// Clutter needs to look like structure around the target, not to be exact: its shapes lie in a
// plane parallel to the plate and are projected by the pinhole part of the camera alone, which is
// defined everywhere.
#pragma once

#include "host_sim/io/camera_model.hpp"
#include "host_sim/render/coverage.hpp"
#include "host_sim/render/random.hpp"
#include "host_sim/render/scene.hpp"

namespace berth::host {

/// A place on the surface and the length there that one pixel spans.
struct Place {
  double x_mm = 0;
  double y_mm = 0;
  double mm_per_px = 1;
};

class PayloadPlane {
 public:
  PayloadPlane(const Camera& camera, const Pose& pose, double depth_mm)
      : camera_(camera), pose_(pose), depth_mm_(depth_mm) {}

  /// The place that a pixel sees.
  Place place_at(double u_px, double v_px) const;

  /// The place at plate coordinates.
  Place place_of(double x_mm, double y_mm) const;

  /// A place that a random pixel of the image and a border around it sees.
  Place random_place(Random& random, double border_px) const;

  /// Outlines in pixels; empty where a part of the shape would lie behind the camera.
  Polygon circle(const Place& place, double radius_mm) const;
  Polygon rectangle(const Place& place, double length_mm, double width_mm, double angle_rad) const;
  Polygon polygon(const std::vector<std::array<double, 2>>& corners_mm) const;

  Eigen::Vector2d pixel_of(double x_mm, double y_mm) const;

 private:
  Eigen::Vector3d camera_point(double x_mm, double y_mm) const;

  const Camera& camera_;
  const Pose& pose_;
  double depth_mm_;
};

}  // namespace berth::host
