// How the light falls on the plate, as a factor for each cell of a grid in the image.
#pragma once

#include "host_sim/render/coverage.hpp"
#include "host_sim/render/outline.hpp"

namespace berth::host {

/// Factor in [0, 1]: the gradient, linear across the plate and constant beyond it, times the cast
/// shadow. Both are attached to the plate's plane and seen along the line of sight.
class LightField {
 public:
  LightField(const Scene& scene, const Camera& camera, const Target& target, int margin_px);

  /// False where the factor is one everywhere.
  bool is_uneven() const { return is_uneven_; }

  /// The factors of one row of a grid that lies within the image and its margin.
  void fill_row(const Grid& grid, int y, float* out) const;

 private:
  struct Node {
    float gradient;   ///< -1 (darkest) to 1 (brightest place of the plate), linear in between
    float shadow_mm;  ///< distance into the shadow
  };
  void fill_nodes(const Scene& scene, const Camera& camera, const Target& target);
  float factor(float gradient, float shadow_mm, float inverse_width) const;

  bool is_uneven_ = false;
  float darkest_ = 1;      ///< factor at gradient -1
  float shadow_loss_ = 0;  ///< 1 - what the shadow leaves
  double penumbra_mm_ = 0;
  double pixel_mm_ = 1;
  int origin_px_ = 0;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<Node> nodes_;
};

}  // namespace berth::host
