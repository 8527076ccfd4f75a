// The Cramer-Rao bound of a frame's pose: what no unbiased estimator can beat.
//
//   F = sum over pixels of dI/dp dI/dp^T / sigma^2,  p = (delta, dt, white, black, blur)
//
// with R = exp(delta) R_0 and the last three as nuisance parameters; the bound is the upper left
// 6 x 6 block of F^-1. The plate's own border carries no information here (markers only).
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "host_sim/render/sample_scene.hpp"
#include "host_sim/render/scene.hpp"

namespace berth::accuracy {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// From the renderer's noise-free image by central differences; about 20 renderings.
Matrix6 bound_from_renderings(const host::Scene& scene, const host::Camera& camera,
                              const host::Target& target);

/// The same integrated along the visible outlines (collars, occluders, gradient, shadow and
/// saturation taken into account; glints and penumbrae not):
///   F = sum of integrals of C^2 / (2 sqrt(pi) s sigma^2) (1 - e^{-w^2 / 4 s^2}) J J^T dl
/// with s the blur across the edge (pixel area included), w the distance to the opposite edge and J
/// the outline's normal displacement. Levels and blur are nearly orthogonal to it and left out.
Matrix6 bound_from_outlines(const host::Scene& scene, const host::Camera& camera,
                            const host::Target& target);

/// A straight edge between black and white on the plate (mm), `width_mm` from the next one.
struct PlateEdge {
  Eigen::Vector2d a, b;
  double width_mm;
};

/// The same bound of any pattern on the plate, for its visible edges.
Matrix6 bound_from_edges(const host::Scene& scene, const host::Camera& camera,
                         const host::Target& plate, const std::vector<PlateEdge>& edges);

/// Root of the trace of the rotation block, degrees, and of the translation block, mm.
double rotation_sigma_deg(const Matrix6& covariance);
double translation_sigma_mm(const Matrix6& covariance);

/// exp of a rotation vector.
Eigen::Matrix3d rotation_of(const Eigen::Vector3d& vector);

/// The pose moved by (delta, dt).
host::Pose moved(const host::Pose& pose, const Vector6& step);

}  // namespace berth::accuracy
