#include "host_sim/render/marker_layer.hpp"

#include <algorithm>

namespace berth::host {
namespace {

// One marker: outlines with weight +1 or -1 (a hole), and what lies in front of it.
struct Marker {
  Polygon outer;
  Polygon hole;
  double z_mm = 0;
};

struct Cover {
  Polygon outline;
  double z_mm = 0;
};

std::vector<Marker> project_markers(const View& view, const Target& target) {
  std::vector<Marker> markers;
  const Eigen::Vector3d origin(0.0, 0.0, 0.0);
  markers.push_back({project_circle(view, origin, target.ring.outer),
                     project_circle(view, origin, target.ring.inner), 0.0});
  markers.push_back({project_line(view, target.line), {}, 0.0});
  for (const Dot& dot : target.dots) {
    const Eigen::Vector3d center(dot.center[0], dot.center[1], dot.center[2]);
    markers.push_back({project_circle(view, center, dot.radius), {}, dot.center[2]});
  }
  return markers;
}

std::vector<Cover> project_covers(const Scene& scene, const View& view, const Target& target) {
  std::vector<Cover> covers;
  for (const Dot& dot : target.dots) {
    if (dot.center[2] == 0.0) continue;
    const Eigen::Vector3d center(dot.center[0], dot.center[1], dot.center[2]);
    if (dot.post_radius > 0.0) covers.push_back({project_post(view, dot), dot.center[2]});
    const double radius = std::max(dot.radius, dot.collar_radius);
    covers.push_back({project_circle(view, center, radius), dot.center[2]});
  }
  for (const Occluder& occluder : scene.occluders) {
    covers.push_back({project_polygon(view, occluder.outline_mm, occluder.z_mm), occluder.z_mm});
  }
  return covers;
}

bool do_overlap(const Grid& a, const Grid& b) {
  return a.x0_px < b.x0_px + b.width && b.x0_px < a.x0_px + a.width &&
         a.y0_px < b.y0_px + b.height && b.y0_px < a.y0_px + a.height;
}

// Multiplies the marker by the uncovered part of each cell.
void hide_behind(const std::vector<Cover>& covers, const Marker& marker, const Grid& limit,
                 MarkerScratch& scratch) {
  const Grid grid = scratch.marker.grid();
  const Grid marker_box = grid_around(marker.outer, 0, 1, limit);
  for (const Cover& cover : covers) {
    if (cover.z_mm >= marker.z_mm) continue;
    if (!do_overlap(marker_box, grid_around(cover.outline, 0, 1, limit))) continue;
    scratch.cover.reset(grid);
    scratch.cover.add_polygon(cover.outline);
    scratch.cover.resolve();
    for (int y = 0; y < grid.height; ++y) {
      float* cells = scratch.marker.row(y);
      const float* covered = scratch.cover.row(y);
      for (int x = 0; x < grid.width; ++x) cells[x] *= 1.0f - covered[x];
    }
  }
}

void illuminate(const LightField& light, MarkerScratch& scratch) {
  if (!light.is_uneven()) return;
  const Grid& grid = scratch.marker.grid();
  scratch.light.resize(static_cast<size_t>(grid.width));
  for (int y = 0; y < grid.height; ++y) {
    light.fill_row(grid, y, scratch.light.data());
    float* cells = scratch.marker.row(y);
    for (int x = 0; x < grid.width; ++x) cells[x] *= scratch.light[x];
  }
}

void blur_to_pixels(const Psf& psf, MarkerScratch& scratch) {
  const Grid& grid = scratch.marker.grid();
  ConstPlaneView cells{scratch.marker.row(0), static_cast<size_t>(grid.width) + 2, grid.width,
                       grid.height};
  if (!psf.taps.empty()) {
    convolve_taps(cells, psf.taps, scratch.moved);
    cells = view_of(scratch.moved);
  }
  convolve_rows(cells, psf.x, kCellsPerPixel, scratch.lanes, scratch.rows);
  convolve_columns(view_of(scratch.rows), psf.y, kCellsPerPixel, scratch.tile);
}

void add_tile(const Plane& tile, const Grid& grid, float gain, Plane& image) {
  const int first = std::max(0, -grid.x0_px);
  const int last = std::min(tile.width, image.width - grid.x0_px);
  for (int y = 0; y < tile.height; ++y) {
    const int image_y = grid.y0_px + y;
    if (image_y < 0 || image_y >= image.height) continue;
    float* out = image.row(image_y) + grid.x0_px;
    const float* in = tile.row(y);
    for (int x = first; x < last; ++x) out[x] += gain * in[x];
  }
}

}  // namespace

void add_markers(const Scene& scene, const Camera& camera, const Target& target,
                 const LightField& light, MarkerScratch& scratch, Plane& image) {
  const Psf psf = make_psf(scene.optics, kCellsPerPixel);
  const int margin = psf.radius_cells / kCellsPerPixel + 2;
  const Grid limit{-margin, -margin, camera.width + 2 * margin, camera.height + 2 * margin, 1};
  const View view{camera, scene.pose};
  const double step = scene.light.white_dn - scene.light.black_dn;
  const float gain = static_cast<float>(target.white_on_black ? step : -step);
  const std::vector<Cover> covers = project_covers(scene, view, target);
  for (const Marker& marker : project_markers(view, target)) {
    const Grid grid = grid_around(marker.outer, margin, kCellsPerPixel, limit);
    if (grid.width == 0 || grid.height == 0) continue;
    scratch.marker.reset(grid);
    scratch.marker.add_polygon(marker.outer);
    scratch.marker.add_polygon(marker.hole, -1.0f);
    scratch.marker.resolve();
    hide_behind(covers, marker, limit, scratch);
    illuminate(light, scratch);
    blur_to_pixels(psf, scratch);
    add_tile(scratch.tile, grid, gain, image);
  }
}

}  // namespace berth::host
