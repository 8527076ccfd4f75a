#include "host_sim/render/coverage.hpp"

#include <algorithm>
#include <cmath>

namespace berth::host {
namespace {

double signed_area(const Polygon& p) {
  double area = 0.0;
  for (size_t i = 0, j = p.size() - 1; i < p.size(); j = i++) {
    area += p[j].x() * p[i].y() - p[i].x() * p[j].y();
  }
  return 0.5 * area;
}

}  // namespace

Grid grid_around(const Polygon& outline_px, int margin_px, int cells_per_px, const Grid& limit) {
  double left = 1e9, top = 1e9, right = -1e9, bottom = -1e9;
  for (const Eigen::Vector2d& p : outline_px) {
    left = std::min(left, p.x());
    right = std::max(right, p.x());
    top = std::min(top, p.y());
    bottom = std::max(bottom, p.y());
  }
  const double limit_right = limit.x0_px + limit.width;
  const double limit_bottom = limit.y0_px + limit.height;
  const auto clamp_cell = [](double v, double low, double high) {
    return static_cast<int>(std::clamp(v, low, high));
  };
  Grid grid;
  grid.cells_per_px = cells_per_px;
  grid.x0_px = clamp_cell(std::floor(left + 0.5) - margin_px, limit.x0_px, limit_right);
  grid.y0_px = clamp_cell(std::floor(top + 0.5) - margin_px, limit.y0_px, limit_bottom);
  const int x1 = clamp_cell(std::ceil(right + 0.5) + margin_px, limit.x0_px, limit_right);
  const int y1 = clamp_cell(std::ceil(bottom + 0.5) + margin_px, limit.y0_px, limit_bottom);
  grid.width = std::max(0, x1 - grid.x0_px) * cells_per_px;
  grid.height = std::max(0, y1 - grid.y0_px) * cells_per_px;
  return grid;
}

void CoverageBuffer::reset(const Grid& grid) {
  grid_ = grid;
  stride_ = static_cast<size_t>(grid.width) + 2;  // an edge at the right border spills two cells
  cells_.assign(stride_ * static_cast<size_t>(grid.height), 0.0f);
}

void CoverageBuffer::add_polygon(const Polygon& outline_px, float weight) {
  if (outline_px.size() < 3 || grid_.width == 0 || grid_.height == 0) return;
  const double s = grid_.cells_per_px;
  const double direction = signed_area(outline_px) > 0.0 ? -weight : weight;
  const auto to_cells = [&](const Eigen::Vector2d& p) {
    return Eigen::Vector2d((p.x() + 0.5 - grid_.x0_px) * s, (p.y() + 0.5 - grid_.y0_px) * s);
  };
  Eigen::Vector2d previous = to_cells(outline_px.back());
  for (const Eigen::Vector2d& p : outline_px) {
    const Eigen::Vector2d current = to_cells(p);
    if (previous.y() < current.y()) {
      add_edge(previous.x(), previous.y(), current.x(), current.y(), direction);
    } else if (current.y() < previous.y()) {
      add_edge(current.x(), current.y(), previous.x(), previous.y(), -direction);
    }
    previous = current;
  }
}

// Cuts a downward edge to the grid: what lies to the left acts on the whole row from its first
// cell, what lies to the right acts on nothing.
void CoverageBuffer::add_edge(double xa, double ya, double xb, double yb, double weight) {
  const double width = grid_.width;
  const double height = grid_.height;
  if (yb <= 0.0 || ya >= height) return;
  const double slope = (xb - xa) / (yb - ya);
  const double y_top = std::max(ya, 0.0);
  const double y_bottom = std::min(yb, height);
  double cuts[4] = {y_top, y_bottom, y_bottom, y_bottom};
  if (slope != 0.0) {
    const double at_left = ya + (0.0 - xa) / slope;
    const double at_right = ya + (width - xa) / slope;
    cuts[1] = std::clamp(std::min(at_left, at_right), y_top, y_bottom);
    cuts[2] = std::clamp(std::max(at_left, at_right), y_top, y_bottom);
  }
  for (int i = 0; i < 3; ++i) {
    const double y0 = cuts[i];
    const double y1 = cuts[i + 1];
    if (!(y1 > y0)) continue;
    const double x0 = std::clamp(xa + (y0 - ya) * slope, 0.0, width);
    const double x1 = std::clamp(xa + (y1 - ya) * slope, 0.0, width);
    if (x0 < width || x1 < width) add_inner_edge(x0, y0, x1, y1, weight);
  }
}

void CoverageBuffer::add_inner_edge(double xa, double ya, double xb, double yb, double weight) {
  const double slope = (xb - xa) / (yb - ya);
  const int first = static_cast<int>(ya);
  const int last = std::min(static_cast<int>(std::ceil(yb)), grid_.height) - 1;
  double x = xa;
  double y = ya;
  for (int row = first; row <= last; ++row) {
    const double y_next = row == last ? yb : row + 1.0;
    const double x_next =
        row == last ? xb : std::clamp(xa + (y_next - ya) * slope, 0.0, double(grid_.width));
    if (y_next > y) add_row_edge(row, x, x_next, (y_next - y) * weight);
    x = x_next;
    y = y_next;
  }
}

// An edge within one row, from x = xa to xb, of the given signed height.
void CoverageBuffer::add_row_edge(int y, double xa, double xb, double height) {
  float* cells = row(y);
  const double left = std::min(xa, xb);
  const double right = std::max(xa, xb);
  const int first = static_cast<int>(left);
  const int last = static_cast<int>(right);
  if (first == last) {
    const double beside = 0.5 * (left + right) - first;  // uncovered part of the cell
    cells[first] += static_cast<float>(height * (1.0 - beside));
    cells[first + 1] += static_cast<float>(height * beside);
    return;
  }
  // Covered area of each crossed cell grows as a parabola in the first, a line in the middle and a
  // parabola in the last; differences of neighbours are accumulated.
  const double per_cell = height / (right - left);
  double reached = 0.0;
  double before = 0.0;
  for (int cell = first; cell <= last; ++cell) {
    const double x0 = std::max(left, double(cell));
    const double x1 = std::min(right, cell + 1.0);
    const double rise = (x1 - x0) * per_cell;
    const double area =
        reached * (x1 - x0) + 0.5 * rise * (x1 - x0) + (reached + rise) * (cell + 1.0 - x1);
    cells[cell] += static_cast<float>(area - before);
    before = area;
    reached += rise;
  }
  cells[last + 1] += static_cast<float>(height - before);
}

void CoverageBuffer::resolve() {
  for (int y = 0; y < grid_.height; ++y) {
    float* cells = row(y);
    float sum = 0.0f;
    for (int x = 0; x < grid_.width; ++x) {
      sum += cells[x];
      cells[x] = sum;
    }
  }
}

}  // namespace berth::host
