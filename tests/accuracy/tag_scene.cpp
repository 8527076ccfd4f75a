#include "accuracy/tag_scene.hpp"

#include <apriltag/apriltag.h>
#include <apriltag/common/image_u8.h>
#include <apriltag/tag36h11.h>

#include "host_sim/render/base_layer.hpp"
#include "host_sim/render/marker_layer.hpp"
#include "host_sim/render/outline.hpp"
#include "host_sim/render/sensor.hpp"

namespace berth::accuracy {

bool TagPattern::is_white(int x, int y) const {
  if (x < 0 || y < 0 || x >= side || y >= side) return false;
  return white[static_cast<size_t>(y * side + x)];
}

std::array<Eigen::Vector3d, 4> TagPattern::corners() const {
  const double c = (0.5 * side - 1) * cell_mm;
  return {Eigen::Vector3d(-c, -c, 0), Eigen::Vector3d(c, -c, 0), Eigen::Vector3d(c, c, 0),
          Eigen::Vector3d(-c, c, 0)};
}

TagPattern tag_36h11(double plate_mm) {
  apriltag_family_t* family = tag36h11_create();
  image_u8_t* image = apriltag_to_image(family, 0);
  TagPattern tag;
  tag.side = image->width;
  tag.cell_mm = 0.98 * plate_mm / tag.side;
  for (int y = 0; y < tag.side; ++y) {
    for (int x = 0; x < tag.side; ++x) tag.white.push_back(image->buf[y * image->stride + x] > 127);
  }
  image_u8_destroy(image);
  tag36h11_destroy(family);
  return tag;
}

host::Target bare_plate(const host::Target& target) {
  host::Target plate = target;
  plate.dots.clear();
  return plate;
}

namespace {

host::Polygon cell_polygon(const host::View& view, const TagPattern& tag, int x, int y) {
  const double x0 = tag.place_mm(x), y0 = tag.place_mm(y), c = tag.cell_mm;
  return host::project_polygon(view, {{x0, y0}, {x0 + c, y0}, {x0 + c, y0 + c}, {x0, y0 + c}}, 0);
}

// The white cells' share of the radiance under even light, as marker_layer does for the markers.
void add_cells(const host::Scene& scene, const host::Camera& camera, const TagPattern& tag,
               host::Plane& image) {
  const host::Psf psf = host::make_psf(scene.optics, host::kCellsPerPixel);
  const int margin = psf.radius_cells / host::kCellsPerPixel + 2;
  const host::View view{camera, scene.pose};
  const host::Grid limit{-margin, -margin, camera.width + 2 * margin, camera.height + 2 * margin,
                         1};
  const double end = tag.place_mm(tag.side);
  const host::Polygon whole =
      host::project_polygon(view, {{-end, -end}, {end, -end}, {end, end}, {-end, end}}, 0);
  const host::Grid grid = host::grid_around(whole, margin, host::kCellsPerPixel, limit);
  host::MarkerScratch s;
  s.marker.reset(grid);
  for (int y = 0; y < tag.side; ++y) {
    for (int x = 0; x < tag.side; ++x) {
      if (tag.is_white(x, y)) s.marker.add_polygon(cell_polygon(view, tag, x, y));
    }
  }
  s.marker.resolve();
  host::ConstPlaneView cells{s.marker.row(0), static_cast<size_t>(grid.width) + 2, grid.width,
                             grid.height};
  if (!psf.taps.empty()) {
    host::convolve_taps(cells, psf.taps, s.moved);
    cells = host::view_of(s.moved);
  }
  host::convolve_rows(cells, psf.x, host::kCellsPerPixel, s.lanes, s.rows);
  host::convolve_columns(host::view_of(s.rows), psf.y, host::kCellsPerPixel, s.tile);
  const auto gain = static_cast<float>(scene.light.white_dn - scene.light.black_dn);
  for (int y = 0; y < s.tile.height; ++y) {
    const int image_y = grid.y0_px + y;
    if (image_y < 0 || image_y >= image.height) continue;
    for (int x = 0; x < s.tile.width; ++x) {
      const int image_x = grid.x0_px + x;
      if (image_x < 0 || image_x >= image.width) continue;
      image.row(image_y)[image_x] += gain * s.tile.row(y)[x];
    }
  }
}

}  // namespace

std::vector<float> render_tag(const host::Scene& scene, const host::Camera& camera,
                              const host::Target& plate, const TagPattern& tag) {
  const host::LightField light(scene, camera, plate, host::margin_of(scene.optics));
  host::BaseScratch scratch;
  host::Plane image;
  host::render_base(scene, camera, plate, light, scratch, image);
  add_cells(scene, camera, tag, image);
  host::respond(scene, image);
  return image.data;
}

Matrix6 bound_of_tag(const host::Scene& scene, const host::Camera& camera,
                     const host::Target& plate, const TagPattern& tag) {
  std::vector<PlateEdge> edges;
  for (int y = 0; y <= tag.side; ++y) {
    for (int x = 0; x <= tag.side; ++x) {
      const Eigen::Vector2d p(tag.place_mm(x), tag.place_mm(y));
      if (tag.is_white(x, y) != tag.is_white(x, y - 1)) {
        edges.push_back({p, p + Eigen::Vector2d(tag.cell_mm, 0), tag.cell_mm});
      }
      if (tag.is_white(x, y) != tag.is_white(x - 1, y)) {
        edges.push_back({p, p + Eigen::Vector2d(0, tag.cell_mm), tag.cell_mm});
      }
    }
  }
  return bound_from_edges(scene, camera, plate, edges);
}

}  // namespace berth::accuracy
