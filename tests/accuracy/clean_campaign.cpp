#include "accuracy/clean_campaign.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "host_sim/parameters/build_block.hpp"
#include "host_sim/render/render.hpp"

namespace berth::accuracy {
namespace {

constexpr double kDegPerRad = 180 / 3.14159265358979323846;

// A start whose outlines lie about `start_px` off.
host::Pose disturbed(const host::Pose& pose, const host::Camera& camera, double start_px,
                     std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const double mm = start_px * pose.t.norm() / camera.fx;
  Vector6 step;
  for (int i = 0; i < 6; ++i) step[i] = 0.6 * mm * normal(random);
  step[0] /= 20;  // out of the plane's axis: little motion in the image
  step[1] /= 20;
  step[2] /= 60;
  step[5] *= 4;
  return moved(pose, step);
}

}  // namespace

Rig make_rig(bool distorted) {
  Rig rig;
  rig.host_camera = host::default_camera();
  if (!distorted) {
    rig.host_camera.k1 = rig.host_camera.k2 = rig.host_camera.p1 = rig.host_camera.p2 =
        rig.host_camera.k3 = 0;
    rig.host_camera.name = "pinhole";
  }
  rig.host_target = host::default_target();
  const auto parameters = host::make_parameters(rig.host_camera, rig.host_target).value();
  rig.camera = parameters.camera;
  rig.target = parameters.target;
  return rig;
}

RigidTransform flight_pose(const host::Pose& pose) {
  RigidTransform out;
  for (int i = 0; i < 3; ++i) {
    out.translation_mm[i] =
        Mm::from_raw(static_cast<std::int32_t>(std::lround(pose.t[i] * 262144)));
    for (int j = 0; j < 3; ++j) {
      out.rotation(i, j) =
          Unit::from_raw(static_cast<std::int32_t>(std::lround(pose.R(i, j) * 1073741824.0)));
    }
  }
  return out;
}

Vector6 pose_error(const RigidTransform& estimate, const host::Pose& truth) {
  Eigen::Matrix3d r;
  Vector6 error;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) r(i, j) = estimate.rotation(i, j).raw() / 1073741824.0;
    error[3 + i] = estimate.translation_mm[i].raw() / 262144.0 - truth.t[i];
  }
  const Eigen::AngleAxisd turn(r * truth.R.transpose());
  error.head<3>() = turn.angle() * turn.axis();
  return error;
}

Matrix6 matrix_of(const PoseCovariance& covariance) {
  Vector6 sigma;
  for (int i = 0; i < 3; ++i) {
    sigma[i] = covariance.sigma_rotation[i].raw() / 268435456.0;
    sigma[3 + i] = covariance.sigma_translation_mm[i].raw() / 262144.0;
  }
  Matrix6 m;
  int next = 0;
  for (int i = 0; i < 6; ++i) {
    m(i, i) = sigma[i] * sigma[i];
    for (int j = i + 1; j < 6; ++j) {
      m(i, j) = m(j, i) = sigma[i] * sigma[j] * covariance.correlation[next++].raw() / 1073741824.0;
    }
  }
  return m;
}

namespace {

// Sigma on the plate, the mean of all directions, a tenth too small.
Mm rough_blur(const host::Scene& scene, const host::Camera& camera) {
  const host::Optics& optics = scene.optics;
  const double variance_px =
      0.3 + optics.defocus_px * optics.defocus_px + optics.motion_px * optics.motion_px / 24;
  const double sigma_mm = 0.9 * std::sqrt(variance_px) * scene.pose.t.z() / camera.fx;
  return Mm::from_raw(static_cast<std::int32_t>(std::ldexp(sigma_mm, 18)));
}

}  // namespace

Trial refine_rendered(const Rig& rig, const host::Scene& scene, const host::Image8& image,
                      double start_px, std::uint64_t seed) {
  ImageView view;
  view.pixels = image.data.data();
  view.width = image.width;
  view.height = image.height;
  view.stride = image.width;
  const host::Pose start = disturbed(scene.pose, rig.host_camera, start_px, seed);
  // Rough levels, noise and blur, as the stages before hand them on.
  const OutlineInput input{rig.camera,
                           rig.target,
                           view,
                           flight_pose(start),
                           static_cast<std::int32_t>(scene.light.black_dn) + 5,
                           static_cast<std::int32_t>(std::min(255.0, scene.light.white_dn)) - 5,
                           static_cast<std::int32_t>(scene.noise_dn * 256),
                           rough_blur(scene, rig.host_camera)};
  const auto workspace = std::make_unique<OutlineWorkspace>();
  Trial trial;
  refine_outlines(input, *workspace, trial.result);
  trial.ok = trial.result.reason == Reason::kNone;
  trial.error = pose_error(trial.result.pose, scene.pose);
  trial.covariance = matrix_of(trial.result.covariance);
  return trial;
}

host::Image8 expose(const std::vector<float>& noise_free, const host::Camera& camera,
                    const Variant& variant, double noise_dn, std::uint64_t seed) {
  if (variant.electrons_per_dn <= 0) {
    return host::quantise(noise_free, camera.width, camera.height, noise_dn, seed);
  }
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<float> signal = noise_free;
  for (float& v : signal) {
    const double shot = std::sqrt(std::max(0.0f, v) / variant.electrons_per_dn);
    v += static_cast<float>(shot * normal(random));
  }
  return host::quantise(signal, camera.width, camera.height, noise_dn, seed);
}

namespace {

// ok, errors over their bounds squared, NEES / 6, errors.
std::vector<double> measure_image(const Rig& rig, host::Scene scene, int index,
                                  const Variant& variant) {
  if (variant.change) variant.change(scene, index);
  std::vector<float> clean;
  host::render(scene, rig.host_camera, rig.host_target, clean);
  const host::Image8 image =
      expose(clean, rig.host_camera, variant, scene.noise_dn, scene.noise_seed);
  const Trial trial =
      refine_rendered(rig, scene, image, 0.3, static_cast<std::uint64_t>(index) + 1);
  if (!trial.ok) return {0};
  if (variant.electrons_per_dn > 0) {
    const double mean = 0.5 * (scene.light.black_dn + scene.light.white_dn);
    scene.noise_dn = std::sqrt(scene.noise_dn * scene.noise_dn + mean / variant.electrons_per_dn);
  }
  const Matrix6 bound = bound_from_outlines(scene, rig.host_camera, rig.host_target);
  const double rotation = trial.error.head<3>().norm() * kDegPerRad;
  const double translation = trial.error.tail<3>().norm();
  return {1,
          std::pow(rotation / rotation_sigma_deg(bound), 2),
          std::pow(translation / translation_sigma_mm(bound), 2),
          trial.error.dot(trial.covariance.ldlt().solve(trial.error)) / 6,
          rotation * rotation,
          translation * translation};
}

}  // namespace

Band measure_band(const Rig& rig, double distance_mm, int images, Ledger& ledger,
                  const Variant& variant) {
  Band band;
  double sums[5] = {};
  for (int i = 0; i < images; ++i) {
    host::SceneOptions options;
    options.seed = 41;
    options.clean = true;
    options.distance_mm = distance_mm;
    options.tilt_deg = 40.0 * (i + 0.5) / images;
    const std::string key = "band/" + variant.name + "/" + rig.host_camera.name + "/" +
                            std::to_string(distance_mm) + "/" + std::to_string(i) + "/" +
                            std::to_string(images);
    const std::vector<double> v = ledger.values(key, [&] {
      const host::Scene scene = host::sample_scene(options, static_cast<std::uint64_t>(i),
                                                   rig.host_camera, rig.host_target);
      return measure_image(rig, scene, i, variant);
    });
    ++band.images;
    if (v.size() != 6) {
      ++band.failed;
      continue;
    }
    for (size_t k = 0; k < 5; ++k) sums[k] += v[k + 1];
  }
  const int n = std::max(1, band.images - band.failed);
  band.rotation = std::sqrt(sums[0] / n);
  band.translation = std::sqrt(sums[1] / n);
  band.nees = sums[2] / n;
  band.rotation_deg = std::sqrt(sums[3] / n);
  band.translation_mm = std::sqrt(sums[4] / n);
  return band;
}

Vector6 measure_bias(const Rig& rig, const host::Scene& scene, int draws) {
  std::vector<float> clean;
  host::render(scene, rig.host_camera, rig.host_target, clean);
  const Matrix6 bound = bound_from_outlines(scene, rig.host_camera, rig.host_target);
  Vector6 mean = Vector6::Zero();
  for (int i = 0; i < draws; ++i) {
    const auto seed = static_cast<std::uint64_t>(i) + 1;
    const host::Image8 image =
        host::quantise(clean, rig.host_camera.width, rig.host_camera.height, scene.noise_dn, seed);
    mean += refine_rendered(rig, scene, image, 0.3, seed).error / draws;
  }
  for (int k = 0; k < 6; ++k) mean[k] /= std::sqrt(bound(k, k));
  return mean;
}

Vector6 measure_bias(const Rig& rig, int index, int draws, Ledger& ledger) {
  const std::string key = "bias/" + std::to_string(index) + "/" + std::to_string(draws);
  const std::vector<double> v = ledger.values(key, [&] {
    host::SceneOptions options;
    options.seed = 47;
    options.clean = true;
    const host::Scene scene = host::sample_scene(options, static_cast<std::uint64_t>(index),
                                                 rig.host_camera, rig.host_target);
    const Vector6 bias = measure_bias(rig, scene, draws);
    return std::vector<double>(bias.data(), bias.data() + 6);
  });
  return Eigen::Map<const Vector6>(v.data());
}

}  // namespace berth::accuracy
