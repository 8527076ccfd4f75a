#include "accuracy/envelope_campaign.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace berth::accuracy {
namespace {

constexpr double kDegPerRad = 180 / 3.14159265358979323846;
constexpr double kChiSquare95 = 12.592;  // six degrees of freedom
constexpr int kDraws = 400;
constexpr double kRotation_deg = 0.015, kTranslation_mm = 0.2, kAt_mm = 300;

double limit_scale(double distance_mm) { return std::pow(distance_mm / kAt_mm, 2); }

bool is_within_limits(double rotation_deg, double translation_mm, double distance_mm) {
  const double scale = limit_scale(distance_mm);
  return rotation_deg <= kRotation_deg * scale && translation_mm <= kTranslation_mm * scale;
}

// Share of normal errors with the bound's covariance that are within the limits.
double share_within_limits(const Matrix6& bound, double distance_mm) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const Matrix6 root = bound.llt().matrixL();
  int within = 0;
  for (int i = 0; i < kDraws; ++i) {
    Vector6 z;
    for (int k = 0; k < 6; ++k) z[k] = normal(random);
    const Vector6 e = root * z;
    within += is_within_limits(e.head<3>().norm() * kDegPerRad, e.tail<3>().norm(), distance_mm);
  }
  return static_cast<double>(within) / kDraws;
}

std::vector<double> measure_frame(const Rig& rig, std::uint64_t seed, std::uint64_t index) {
  host::SceneOptions options;
  options.seed = seed;
  const host::Scene scene = host::sample_scene(options, index, rig.host_camera, rig.host_target);
  if (!scene.is_plate_inside) return {};
  const host::Image8 image = host::render_frame(scene, rig.host_camera, rig.host_target);
  const Trial trial = refine_rendered(rig, scene, image, 0.3, index + 1);
  const Matrix6 bound = bound_from_outlines(scene, rig.host_camera, rig.host_target);
  const double distance = scene.pose.t.norm();
  const double nees =
      trial.ok ? trial.error.dot(trial.covariance.ldlt().solve(trial.error)) / 6 : 0;
  return {trial.ok ? 1.0 : 0.0,
          distance,
          nees,
          trial.error.head<3>().norm() * kDegPerRad,
          trial.error.tail<3>().norm(),
          rotation_sigma_deg(bound),
          translation_sigma_mm(bound),
          share_within_limits(bound, distance),
          trial.error.dot(bound.ldlt().solve(trial.error)) / 6};
}

}  // namespace

bool EnvelopeFrame::is_precise() const {
  return ok && is_within_limits(rotation_deg, translation_mm, distance_mm);
}

bool EnvelopeFrame::is_well_conditioned() const {
  return is_within_limits(3 * bound_deg, 3 * bound_mm, distance_mm);
}

std::vector<EnvelopeFrame> measure_envelope(const Rig& rig, std::uint64_t seed, int frames,
                                            Ledger& ledger) {
  std::vector<EnvelopeFrame> all;
  for (int i = 0; i < frames; ++i) {
    const std::string key = "envelope/" + std::to_string(seed) + "/" + std::to_string(i);
    const std::vector<double> v =
        ledger.values(key, [&] { return measure_frame(rig, seed, static_cast<std::uint64_t>(i)); });
    if (v.size() != 9) continue;
    all.push_back({v[0] > 0, v[1], v[2], v[3], v[4], v[5], v[6], v[7], v[8]});
  }
  return all;
}

EnvelopeSummary summarise(const std::vector<EnvelopeFrame>& frames, double nearest_mm,
                          double farthest_mm) {
  EnvelopeSummary s;
  std::vector<double> nees;
  int precise_well = 0;
  for (const EnvelopeFrame& f : frames) {
    if (f.distance_mm < nearest_mm || f.distance_mm >= farthest_mm) continue;
    ++s.frames;
    s.precise += f.is_precise();
    s.precise_at_bound += f.precise_at_bound;
    if (f.is_well_conditioned()) {
      ++s.well_conditioned;
      precise_well += f.is_precise();
    }
    if (!f.ok) {
      ++s.failed;
      continue;
    }
    nees.push_back(f.nees);
    s.covered += 6 * f.nees < kChiSquare95;
    s.worst_rotation_deg = std::max(s.worst_rotation_deg, f.rotation_deg);
  }
  if (nees.empty()) return s;
  for (const double v : nees) s.nees += v / static_cast<double>(nees.size());
  std::nth_element(nees.begin(), nees.begin() + static_cast<long>(nees.size() / 2), nees.end());
  s.nees_median = nees[nees.size() / 2];
  s.covered /= static_cast<double>(nees.size());
  s.precise /= s.frames;
  s.precise_at_bound /= s.frames;
  s.precise_well_conditioned = static_cast<double>(precise_well) / std::max(1, s.well_conditioned);
  return s;
}

}  // namespace berth::accuracy
