// The outline refinement in double precision, written from its equations (docs/precision.md).
//
// Crossings are found on the projected outline itself instead of a cubic between vertices, the
// blurred step is evaluated instead of tabulated, pose, edge offset and blur are solved for jointly
// instead of in turn. Even light and nothing hidden: what the comparison at 300 mm needs.
#pragma once

#include "accuracy/bound.hpp"
#include "host_sim/render/render.hpp"

namespace berth::accuracy {

struct TwinInput {
  const host::Camera& camera;
  const host::Target& target;
  const host::Image8& image;
  host::Pose start;
  double black, white;
};

struct TwinResult {
  host::Pose pose;
  Matrix6 covariance;
  Eigen::Vector3d blur_px2;  // xx, xy, yy
};

TwinResult refine_twin(const TwinInput& input);

}  // namespace berth::accuracy
