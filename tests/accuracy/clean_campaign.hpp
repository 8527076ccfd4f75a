// Errors of the outline refinement against the Cramer-Rao bound, on rendered images.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "accuracy/bound.hpp"
#include "accuracy/ledger.hpp"
#include "host_sim/render/render.hpp"
#include "pose/outline.hpp"

namespace berth::accuracy {

/// Camera and target in both worlds.
struct Rig {
  host::Camera host_camera;
  host::Target host_target;
  Camera camera;
  TargetModel target;
};
Rig make_rig(bool distorted);

/// (delta, dt) of an estimate: R_est = exp(delta) R_true.
Vector6 pose_error(const RigidTransform& estimate, const host::Pose& truth);
Matrix6 matrix_of(const PoseCovariance& covariance);
RigidTransform flight_pose(const host::Pose& pose);

/// One refinement from a start `start_px` (rms, in the image) off the truth.
struct Trial {
  bool ok = false;
  Vector6 error = Vector6::Zero();
  Matrix6 covariance = Matrix6::Identity();
  OutlineResult result;
};
Trial refine_rendered(const Rig& rig, const host::Scene& scene, const host::Image8& image,
                      double start_px, std::uint64_t seed);

/// What sets images apart from the clean ones; the estimator is told nothing of it.
struct Variant {
  std::string name = "clean";
  std::function<void(host::Scene&, int index)> change;
  double electrons_per_dn = 0;  // photon noise on top of the scene's own; 0: none
};

/// Noise-free image to frame, photon noise included.
host::Image8 expose(const std::vector<float>& noise_free, const host::Camera& camera,
                    const Variant& variant, double noise_dn, std::uint64_t seed);

/// sqrt(mean(e^2 / bound^2)) over images of one distance, tilt 0 to 40 deg. The bound is that of
/// white noise; with photon noise that of its mean over black and white.
struct Band {
  int images = 0, failed = 0;
  double rotation = 0, translation = 0;         // rms / bound
  double nees = 0;                              // mean, over its expectation 6
  double rotation_deg = 0, translation_mm = 0;  // rms
};
Band measure_band(const Rig& rig, double distance_mm, int images, Ledger& ledger,
                  const Variant& variant = {});

/// Mean error over noise draws on one noise-free render, over the bound, per axis; `index` in the
/// sequence of clean scenes of all distances.
Vector6 measure_bias(const Rig& rig, const host::Scene& scene, int draws);
Vector6 measure_bias(const Rig& rig, int index, int draws, Ledger& ledger);

}  // namespace berth::accuracy
