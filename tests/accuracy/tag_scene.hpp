// A fiducial tag on the same plate: the scenes of the comparison, by the same renderer.
//
// The plate's markers are replaced by a pattern of square cells; light, optics, noise and pose are
// the scene's. The tag is as large as the plate allows with its white margin of one cell.
#pragma once

#include <array>
#include <vector>

#include "accuracy/bound.hpp"
#include "host_sim/render/render.hpp"

namespace berth::accuracy {

/// Cells row by row, margin included; true is white.
struct TagPattern {
  int side = 0;
  double cell_mm = 0;
  std::vector<bool> white;
  bool is_white(int x, int y) const;
  /// Corner of a cell's upper left, target frame.
  double place_mm(int index) const { return (index - 0.5 * side) * cell_mm; }
  /// Corners of the black border, clockwise from the upper left as a camera sees them.
  std::array<Eigen::Vector3d, 4> corners() const;
};

/// Tag 0 of AprilTag's family 36h11, which OpenCV's ArUco reads as well.
TagPattern tag_36h11(double plate_mm);

/// The plate without its markers.
host::Target bare_plate(const host::Target& target);

/// The noise-free image of the tag; its markers, hence `scene.has_target`, are those of the tag.
std::vector<float> render_tag(const host::Scene& scene, const host::Camera& camera,
                              const host::Target& plate, const TagPattern& tag);

Matrix6 bound_of_tag(const host::Scene& scene, const host::Camera& camera,
                     const host::Target& plate, const TagPattern& tag);

}  // namespace berth::accuracy
