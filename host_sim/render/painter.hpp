// Draws anti-aliased shapes on a plane of radiance.
#pragma once

#include "host_sim/render/convolve.hpp"
#include "host_sim/render/coverage.hpp"

namespace berth::host {

/// The look of a surface: a level with a linear slope across the image, and a share of a texture.
struct Paint {
  double level_dn = 0;
  double slope_x = 0;  ///< DN per pixel, zero at the shape's middle
  double slope_y = 0;
  double texture = 0;  ///< relative amplitude
};

/// A spot that falls off smoothly to zero at its elliptical border.
struct Spot {
  Eigen::Vector2d center_px{0.0, 0.0};
  double long_radius_px = 1;
  double short_radius_px = 1;
  double angle_rad = 0;
  double peak_dn = 0;
};

/// Borrows the plane, whose cell (0, 0) is pixel (-margin, -margin), and a buffer to work in.
class Painter {
 public:
  Painter(Plane& plane, int margin_px, CoverageBuffer& coverage);

  /// Texture values for paints to come, a plane of the same size, mean zero; may be null.
  void set_texture(const Plane* texture) { texture_ = texture; }

  /// Calls blend(grid, y, coverage, out) for every row of the outline less the hole.
  template <typename Blend>
  void cover(const Polygon& outline_px, const Polygon& hole_px, Blend blend) {
    const Grid grid = grid_around(outline_px, 0, 1, limit_);
    if (grid.width == 0 || grid.height == 0) return;
    coverage_.reset(grid);
    coverage_.add_polygon(outline_px);
    coverage_.add_polygon(hole_px, -1.0f);
    coverage_.resolve();
    for (int y = 0; y < grid.height; ++y) blend(grid, y, coverage_.row(y), cell_row(grid, y));
  }

  void fill(const Polygon& outline_px, const Paint& paint, const Polygon& hole_px = {});
  void add_spot(const Spot& spot);

  /// The whole plane as a grid.
  const Grid& limit() const { return limit_; }

 private:
  float* cell_row(const Grid& grid, int y) {
    return plane_.row(grid.y0_px + y + margin_) + grid.x0_px + margin_;
  }

  Plane& plane_;
  CoverageBuffer& coverage_;
  const Plane* texture_ = nullptr;
  int margin_;
  Grid limit_;
};

}  // namespace berth::host
