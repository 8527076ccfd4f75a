#include "host_sim/render/base_layer.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/render/background.hpp"
#include "host_sim/render/det_math.hpp"

namespace berth::host {
namespace {

// Draws on the radiance plane, whose cell (0, 0) is pixel (-margin, -margin).
class Canvas {
 public:
  Canvas(BaseScratch& scratch, const LightField& light, int margin_px)
      : scratch_(scratch),
        light_(light),
        margin_(margin_px),
        limit_{-margin_px, -margin_px, scratch.radiance.width, scratch.radiance.height, 1} {}

  void illuminate_all() {
    if (!light_.is_uneven()) return;
    for (int y = 0; y < limit_.height; ++y) {
      const float* factors = light_row(limit_, y);
      float* out = scratch_.radiance.row(y);
      for (int x = 0; x < limit_.width; ++x) out[x] *= factors[x];
    }
  }

  void paint(const Polygon& outline_px, double level_dn) {
    const Grid grid = grid_around(outline_px, 0, 1, limit_);
    scratch_.coverage.reset(grid);
    scratch_.coverage.add_polygon(outline_px);
    scratch_.coverage.resolve();
    const float level = static_cast<float>(level_dn);
    for (int y = 0; y < grid.height; ++y) {
      const float* covered = scratch_.coverage.row(y);
      const float* factors = light_row(grid, y);
      float* out = cell_row(grid, y);
      for (int x = 0; x < grid.width; ++x) {
        out[x] += covered[x] * (level * factors[x] - out[x]);
      }
    }
  }

  void add_spot(const View& view, const Glint& glint) {
    const Polygon outline = project_circle(view, {glint.x_mm, glint.y_mm, 0.0}, glint.radius_mm);
    const Eigen::Vector2d center = project_point(view, {glint.x_mm, glint.y_mm, 0.0});
    const double radius_px = glint.radius_mm * view.camera.fx / view.pose.t.z();
    const double scale = -4.6 / (radius_px * radius_px);  // e^-4.6 is 1 %
    const Grid grid = grid_around(outline, 2, 1, limit_);
    for (int y = 0; y < grid.height; ++y) {
      float* out = cell_row(grid, y);
      for (int x = 0; x < grid.width; ++x) {
        const double dx = grid.x0_px + x - center.x();
        const double dy = grid.y0_px + y - center.y();
        out[x] += static_cast<float>(glint.peak_dn * det_exp(scale * (dx * dx + dy * dy)));
      }
    }
  }

 private:
  float* cell_row(const Grid& grid, int y) {
    return scratch_.radiance.row(grid.y0_px + y + margin_) + grid.x0_px + margin_;
  }

  const float* light_row(const Grid& grid, int y) {
    if (light_.is_uneven()) {
      scratch_.light.resize(static_cast<size_t>(limit_.width));
      light_.fill_row(grid, y, scratch_.light.data());
    } else {
      scratch_.light.assign(static_cast<size_t>(limit_.width), 1.0f);
    }
    return scratch_.light.data();
  }

  BaseScratch& scratch_;
  const LightField& light_;
  int margin_;
  Grid limit_;
};

void paint_target(const Scene& scene, const View& view, const Target& target, Canvas& canvas) {
  const Light& light = scene.light;
  // Collars and posts have the plate's colour.
  const double level = (target.white_on_black ? light.black_dn : light.white_dn) - light.stray_dn;
  canvas.paint(project_plate(view, target), level);
  for (const Dot& dot : target.dots) {
    if (dot.post_radius > 0.0) canvas.paint(project_post(view, dot), level);
    if (dot.collar_radius > 0.0) {
      const Eigen::Vector3d center(dot.center[0], dot.center[1], dot.center[2]);
      canvas.paint(project_circle(view, center, dot.collar_radius), level);
    }
  }
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
  draw_background(scene, camera, target, margin, scratch.radiance);
  Canvas canvas(scratch, light, margin);
  // Space and clouds are too far away to share the plate's light.
  if (scene.background.kind == BackgroundKind::kClutter) canvas.illuminate_all();
  const View view{camera, scene.pose};
  if (scene.has_target) paint_target(scene, view, target, canvas);
  for (const Occluder& occluder : scene.occluders) {
    canvas.paint(project_polygon(view, occluder.outline_mm, occluder.z_mm), occluder.level_dn);
  }
  for (const Glint& glint : scene.glints) canvas.add_spot(view, glint);
  blur(psf, margin, scratch, image);
}

}  // namespace berth::host
