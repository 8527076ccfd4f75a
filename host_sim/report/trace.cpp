#include "host_sim/report/trace.hpp"

#include <cmath>

namespace berth::host {
namespace {

constexpr double kTwoPi = 6.283185307179586;

double to_double(Px value) { return value.raw() / 65536.0; }

/// Grid cells to image pixels; the grid's cells are binned pixels.
cv::Point2d to_image(const SearchGrid& grid, double x, double y) {
  const double middle = (grid.bin - 1) / 2.0;
  return {grid.x0 + grid.bin * x + middle, grid.y0 + grid.bin * y + middle};
}

/// An edge pixel with its sub-cell offset, which lies along the gradient's dominant axis.
cv::Point2d edge_point(const Workspace& workspace, int i) {
  const EdgePixel& pixel = workspace.map[i];
  const double offset = pixel.offset() / 64.0;
  const bool in_x = pixel.is_steep_in_x();
  return to_image(workspace.grid, pixel.x() + (in_x ? offset : 0),
                  workspace.set.row_of[static_cast<std::size_t>(i)] + (in_x ? 0 : offset));
}

Polyline chain_line(const Workspace& workspace, const Chain& chain) {
  Polyline line;
  for (int i = 0; i < chain.count; ++i) {
    const std::size_t entry = static_cast<std::size_t>(chain.start + i);
    line.push_back(edge_point(workspace, workspace.set.order[entry]));
  }
  return line;
}

/// c + M^-1 (cos, sin) all around.
Polyline ellipse_line(const SearchGrid& grid, const Ellipse& ellipse) {
  const auto entry = [&](int i, int j) { return ellipse.m[i][j].raw() / double{1 << 26}; };
  const double a = entry(0, 0), b = entry(0, 1), c = entry(1, 0), d = entry(1, 1);
  const double determinant = a * d - b * c;
  Polyline line;
  for (int i = 0; i < 96 && determinant != 0; ++i) {
    const double cosine = std::cos(kTwoPi * i / 96);
    const double sine = std::sin(kTwoPi * i / 96);
    line.push_back(to_image(grid, to_double(ellipse.cx) + (d * cosine - b * sine) / determinant,
                            to_double(ellipse.cy) + (a * sine - c * cosine) / determinant));
  }
  return line;
}

}  // namespace

Trace read_trace(const Workspace& workspace) {
  Trace trace;
  for (int i = 0; i < workspace.set.count; ++i) {
    trace.chains.push_back(
        chain_line(workspace, workspace.set.chains[static_cast<std::size_t>(i)]));
  }
  for (int i = 0; i < workspace.ring_count; ++i) {
    trace.ellipses.push_back(ellipse_line(workspace.grid, workspace.rings[i].ellipse));
  }
  return trace;
}

void clear_trace(Workspace& workspace) {
  workspace.map.count = 0;
  workspace.set.count = 0;
  workspace.candidate_count = 0;
  workspace.ring_count = 0;
}

}  // namespace berth::host
