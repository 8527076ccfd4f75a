// Exact area coverage of polygons by signed-area accumulation.
//
// Each edge adds, to the cells it crosses, the change of covered area to its right; the running
// sum along a row is then the coverage of each cell, exact for any polygon (no sampling). The same
// idea renders fonts (Levien, "font-rs").
#pragma once

#include <Eigen/Core>
#include <vector>

namespace berth::host {

using Polygon = std::vector<Eigen::Vector2d>;

/// A grid of square cells: cell (i, j) spans [x0 + i/s, x0 + (i+1)/s) in pixels' edge coordinates,
/// in which pixel (0, 0) spans [0, 1); so pixel centre u lies at u + 0.5.
struct Grid {
  int x0_px = 0;
  int y0_px = 0;
  int width = 0;   ///< cells
  int height = 0;  ///< cells
  int cells_per_px = 1;
};

/// Smallest grid of whole pixels that holds the polygon and `margin_px` around it, cut to `limit`.
Grid grid_around(const Polygon& outline_px, int margin_px, int cells_per_px, const Grid& limit);

/// Accumulates outlines on a grid; reusable, since its memory grows only.
class CoverageBuffer {
 public:
  void reset(const Grid& grid);

  /// Adds `weight` times the polygon's coverage, whichever way round the polygon runs.
  void add_polygon(const Polygon& outline_px, float weight = 1.0f);

  /// Turns what was accumulated into coverage; then rows can be read.
  void resolve();

  const Grid& grid() const { return grid_; }
  float* row(int y) { return cells_.data() + static_cast<size_t>(y) * stride_; }
  const float* row(int y) const { return cells_.data() + static_cast<size_t>(y) * stride_; }

 private:
  void add_edge(double xa, double ya, double xb, double yb, double weight);
  void add_inner_edge(double xa, double ya, double xb, double yb, double weight);
  void add_row_edge(int y, double xa, double xb, double height);

  Grid grid_;
  size_t stride_ = 0;
  std::vector<float> cells_;
};

}  // namespace berth::host
