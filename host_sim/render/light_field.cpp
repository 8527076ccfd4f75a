#include "host_sim/render/light_field.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/render/det_math.hpp"

namespace berth::host {
namespace {

constexpr int kNodeSpacing_px = 16;  // plate coordinates bend by less than 0.02 mm in between

// The point of the plate's plane that a pixel sees: X = (r2 x t).m / (r1 x r2).m and so on, with
// the ray m; beyond the plane's horizon a far point.
std::array<double, 2> plate_point(const Camera& camera, const Pose& pose,
                                  const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d linear((pixel.x() - camera.cx) / camera.fx,
                               (pixel.y() - camera.cy) / camera.fy);
  const Eigen::Vector2d ray = undistort(camera, pixel).value_or(linear);
  const Eigen::Matrix3d& R = pose.R;
  const Eigen::Vector3d& t = pose.t;
  const auto triple = [&ray](double ax, double ay, double az, double bx, double by, double bz) {
    return (ay * bz - az * by) * ray.x() + (az * bx - ax * bz) * ray.y() + (ax * by - ay * bx);
  };
  const double w = triple(R(0, 0), R(1, 0), R(2, 0), R(0, 1), R(1, 1), R(2, 1));
  const double x = triple(R(0, 1), R(1, 1), R(2, 1), t.x(), t.y(), t.z());
  const double y = triple(t.x(), t.y(), t.z(), R(0, 0), R(1, 0), R(2, 0));
  const double safe_w = std::max(w, 1e-3);
  return {x / safe_w, y / safe_w};
}

}  // namespace

LightField::LightField(const Scene& scene, const Camera& camera, const Target& target,
                       int margin_px) {
  const Light& light = scene.light;
  is_uneven_ = light.gradient_ratio != 1.0 || light.shadow.has_value();
  if (!is_uneven_) return;
  darkest_ = static_cast<float>(1.0 / light.gradient_ratio);
  if (light.shadow) {
    shadow_loss_ = static_cast<float>(1.0 - light.shadow->leaves);
    penumbra_mm_ = light.shadow->penumbra_mm;
  }
  pixel_mm_ = scene.pose.t.z() / camera.fx;
  origin_px_ = -margin_px - kNodeSpacing_px;
  columns_ = (camera.width + 2 * margin_px) / kNodeSpacing_px + 4;
  rows_ = (camera.height + 2 * margin_px) / kNodeSpacing_px + 4;
  fill_nodes(scene, camera, target);
}

void LightField::fill_nodes(const Scene& scene, const Camera& camera, const Target& target) {
  const SinCos a = det_sincos(scene.light.gradient_angle_rad);
  const double extent =
      0.5 * (target.plate_size_mm[0] * std::abs(a.cos) + target.plate_size_mm[1] * std::abs(a.sin));
  const Shadow shadow = scene.light.shadow.value_or(Shadow{});
  nodes_.resize(static_cast<size_t>(columns_) * rows_);
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      const Eigen::Vector2d pixel(origin_px_ + column * kNodeSpacing_px,
                                  origin_px_ + row * kNodeSpacing_px);
      const auto [x, y] = plate_point(camera, scene.pose, pixel);
      nodes_[static_cast<size_t>(row) * columns_ + column] = {
          static_cast<float>((x * a.cos + y * a.sin) / extent),
          static_cast<float>(shadow.normal_x * x + shadow.normal_y * y - shadow.offset_mm)};
    }
  }
}

float LightField::factor(float gradient, float shadow_mm, float inverse_width) const {
  const float rise = std::min(1.0f, std::max(0.0f, 0.5f + 0.5f * gradient));
  const float depth = std::min(1.0f, std::max(0.0f, 0.5f + shadow_mm * inverse_width));
  return (darkest_ + (1.0f - darkest_) * rise) * (1.0f - shadow_loss_ * depth);
}

void LightField::fill_row(const Grid& grid, int y, float* out) const {
  // A hard edge is as wide as a cell: that is its area coverage.
  const double width_mm = std::max(penumbra_mm_, pixel_mm_ / grid.cells_per_px);
  const float inverse_width = static_cast<float>(1.0 / width_mm);
  const float scale = 1.0f / static_cast<float>(grid.cells_per_px);
  const float per_node = 1.0f / kNodeSpacing_px;
  const float v = ((static_cast<float>(y) + 0.5f) * scale - 0.5f +
                   static_cast<float>(grid.y0_px - origin_px_)) *
                  per_node;
  const int row = std::clamp(static_cast<int>(v), 0, rows_ - 2);
  const float fv = v - static_cast<float>(row);
  const Node* upper = nodes_.data() + static_cast<size_t>(row) * columns_;
  const Node* lower = upper + columns_;
  const float u0 = (0.5f * scale - 0.5f + static_cast<float>(grid.x0_px - origin_px_)) * per_node;
  const auto blend = [](float a, float b, float s) { return a + (b - a) * s; };
  for (int x = 0; x < grid.width;) {
    const float u_first = u0 + static_cast<float>(x) * scale * per_node;
    const int column = std::clamp(static_cast<int>(u_first), 0, columns_ - 2);
    const float g0 = blend(upper[column].gradient, lower[column].gradient, fv);
    const float g1 = blend(upper[column + 1].gradient, lower[column + 1].gradient, fv);
    const float s0 = blend(upper[column].shadow_mm, lower[column].shadow_mm, fv);
    const float s1 = blend(upper[column + 1].shadow_mm, lower[column + 1].shadow_mm, fv);
    const int end = std::min(grid.width, x + kNodeSpacing_px * grid.cells_per_px);
    float fu = u_first - static_cast<float>(column);
    do {
      out[x] = factor(blend(g0, g1, fu), blend(s0, s1, fu), inverse_width);
      ++x;
      fu = u0 + static_cast<float>(x) * scale * per_node - static_cast<float>(column);
    } while (x < end && fu < 1.0f);
  }
}

}  // namespace berth::host
