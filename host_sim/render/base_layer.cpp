#include "host_sim/render/base_layer.hpp"

#include <algorithm>

#include "host_sim/render/outline.hpp"

namespace berth::host {
namespace {

// Multiplies radiance by the light that falls on it.
class Lamp {
 public:
  explicit Lamp(const LightField& field, BaseScratch& scratch) : field_(field), scratch_(scratch) {}

  /// The factors of one row; all one in even light.
  const float* row(const Grid& grid, int y) {
    scratch_.light.resize(static_cast<size_t>(grid.width));
    if (field_.is_uneven()) {
      field_.fill_row(grid, y, scratch_.light.data());
    } else {
      std::fill(scratch_.light.begin(), scratch_.light.end(), 1.0f);
    }
    return scratch_.light.data();
  }

  void illuminate(const Grid& all) {
    if (!field_.is_uneven()) return;
    for (int y = 0; y < all.height; ++y) {
      const float* factors = row(all, y);
      float* out = scratch_.radiance.row(y);
      for (int x = 0; x < all.width; ++x) out[x] *= factors[x];
    }
  }

 private:
  const LightField& field_;
  BaseScratch& scratch_;
};

// A surface of one level under the lamp.
void paint(const Polygon& outline_px, double level_dn, Lamp& lamp, Painter& painter) {
  const float level = static_cast<float>(level_dn);
  painter.cover(outline_px, {}, [&](const Grid& grid, int y, const float* covered, float* out) {
    const float* factors = lamp.row(grid, y);
    for (int x = 0; x < grid.width; ++x) out[x] += covered[x] * (level * factors[x] - out[x]);
  });
}

void paint_target(const Scene& scene, const View& view, const Target& target, Lamp& lamp,
                  Painter& painter) {
  const Light& light = scene.light;
  // Collars and posts have the plate's colour.
  const double level = (target.white_on_black ? light.black_dn : light.white_dn) - light.stray_dn;
  paint(project_plate(view, target), level, lamp, painter);
  for (const Dot& dot : target.dots) {
    if (dot.post_radius > 0.0) paint(project_post(view, dot), level, lamp, painter);
    if (dot.collar_radius > 0.0) {
      const Eigen::Vector3d center(dot.center[0], dot.center[1], dot.center[2]);
      paint(project_circle(view, center, dot.collar_radius), level, lamp, painter);
    }
  }
}

void paint_glint(const View& view, const Glint& glint, Painter& painter) {
  Spot spot;
  spot.center_px = project_point(view, {glint.x_mm, glint.y_mm, 0.0});
  spot.long_radius_px = spot.short_radius_px = glint.radius_mm * view.camera.fx / view.pose.t.z();
  spot.peak_dn = glint.peak_dn;
  painter.add_spot(spot);
}

void blur(const Psf& psf, int margin_px, BaseScratch& scratch, Plane& image) {
  ConstPlaneView cells = view_of(scratch.radiance);
  if (!psf.taps.empty()) {
    convolve_taps(cells, psf.taps, scratch.moved);
    cells = view_of(scratch.moved);
  }
  convolve_rows(cells, psf.x, 1, scratch.lanes, scratch.rows);
  // Only the rows and columns of the image are summed along columns.
  ConstPlaneView rows = view_of(scratch.rows);
  rows.data += margin_px;
  rows.width -= 2 * margin_px;
  convolve_columns(rows, psf.y, 1, scratch.moved);
  image.reset(rows.width, rows.height - 2 * margin_px);
  std::copy_n(scratch.moved.row(margin_px), image.data.size(), image.data.begin());
}

}  // namespace

int margin_of(const Optics& optics) { return make_psf(optics, 1).radius_cells + 1; }

void render_base(const Scene& scene, const Camera& camera, const Target& target,
                 const LightField& light, BaseScratch& scratch, Plane& image) {
  const Psf psf = make_psf(scene.optics, 1);
  const int margin = psf.radius_cells + 1;
  scratch.radiance.reset(camera.width + 2 * margin, camera.height + 2 * margin);
  draw_background(scene, camera, target, margin, scratch.background, scratch.radiance);
  Painter painter(scratch.radiance, margin, scratch.background.coverage);
  Lamp lamp(light, scratch);
  // Space and clouds are too far away to share the plate's light.
  if (scene.background.kind == BackgroundKind::kClutter) lamp.illuminate(painter.limit());
  const View view{camera, scene.pose};
  if (scene.has_target) paint_target(scene, view, target, lamp, painter);
  for (const Occluder& occluder : scene.occluders) {
    paint(project_polygon(view, occluder.outline_mm, occluder.z_mm), occluder.level_dn, lamp,
          painter);
  }
  for (const Glint& glint : scene.glints) paint_glint(view, glint, painter);
  blur(psf, margin, scratch, image);
}

}  // namespace berth::host
