#include "host_sim/render/painter.hpp"

#include <algorithm>

#include "host_sim/render/det_math.hpp"

namespace berth::host {

Painter::Painter(Plane& plane, int margin_px, CoverageBuffer& coverage)
    : plane_(plane),
      coverage_(coverage),
      margin_(margin_px),
      limit_{-margin_px, -margin_px, plane.width, plane.height, 1} {}

void Painter::fill(const Polygon& outline_px, const Paint& paint, const Polygon& hole_px) {
  const float slope_x = static_cast<float>(paint.slope_x);
  const float slope_y = static_cast<float>(paint.slope_y);
  const float texture = texture_ == nullptr ? 0.0f : static_cast<float>(paint.texture);
  cover(outline_px, hole_px, [&](const Grid& grid, int y, const float* covered, float* out) {
    const float across = static_cast<float>(y) - 0.5f * static_cast<float>(grid.height);
    const float start = static_cast<float>(paint.level_dn) + slope_y * across -
                        slope_x * 0.5f * static_cast<float>(grid.width);
    if (texture == 0.0f) {
      for (int x = 0; x < grid.width; ++x) {
        const float level = std::max(0.0f, start + slope_x * static_cast<float>(x));
        out[x] += covered[x] * (level - out[x]);
      }
      return;
    }
    const float* pattern = texture_->row(grid.y0_px + y + margin_) + grid.x0_px + margin_;
    for (int x = 0; x < grid.width; ++x) {
      const float level = (start + slope_x * static_cast<float>(x)) * (1.0f + texture * pattern[x]);
      out[x] += covered[x] * (std::max(0.0f, level) - out[x]);
    }
  });
}

// (1 - r^2)^2 inside the ellipse.
void Painter::add_spot(const Spot& spot) {
  const double reach = std::max(spot.long_radius_px, spot.short_radius_px);
  const Eigen::Vector2d& c = spot.center_px;
  const Polygon box{{c.x() - reach, c.y() - reach}, {c.x() + reach, c.y() + reach}};
  const Grid grid = grid_around(box, 0, 1, limit_);
  const SinCos a = det_sincos(spot.angle_rad);
  for (int y = 0; y < grid.height; ++y) {
    float* out = cell_row(grid, y);
    for (int x = 0; x < grid.width; ++x) {
      const double dx = grid.x0_px + x - c.x();
      const double dy = grid.y0_px + y - c.y();
      const double u = (a.cos * dx + a.sin * dy) / spot.long_radius_px;
      const double v = (a.cos * dy - a.sin * dx) / spot.short_radius_px;
      const double rest = std::max(0.0, 1.0 - u * u - v * v);
      out[x] += static_cast<float>(spot.peak_dn * rest * rest);
    }
  }
}

}  // namespace berth::host
