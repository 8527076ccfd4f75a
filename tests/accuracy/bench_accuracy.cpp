// bench_accuracy [images per distance] [poses for the bias] [draws]: precision against the bound.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "accuracy/clean_campaign.hpp"

namespace {

using namespace berth::accuracy;

void print_bands(bool distorted, int images) {
  const Rig rig = make_rig(distorted);
  std::printf("\nrms error / bound, clean images, tilt 0 to 40 deg, %d images each, %s\n", images,
              distorted ? "HEC-1's distortion" : "no distortion");
  std::printf("   mm  rotation  translation  NEES/6   rms deg    rms mm  failed\n");
  for (const double distance : {300.0, 500.0, 800.0, 1100.0, 1500.0}) {
    const Band b = measure_band(rig, distance, images);
    std::printf("%5.0f  %8.3f  %11.3f  %6.3f  %8.5f  %8.5f  %6d\n", distance, b.rotation,
                b.translation, b.nees, b.rotation_deg, b.translation_mm, b.failed);
  }
}

void print_bias(int poses, int draws) {
  const Rig rig = make_rig(false);
  std::vector<double> all;
  for (int i = 0; i < poses; ++i) {
    berth::host::SceneOptions options;
    options.seed = 47;
    options.clean = true;
    const auto scene = berth::host::sample_scene(options, static_cast<std::uint64_t>(i),
                                                 rig.host_camera, rig.host_target);
    const Vector6 bias = measure_bias(rig, scene, draws);
    for (int k = 0; k < 6; ++k) all.push_back(std::abs(bias[k]));
  }
  std::sort(all.begin(), all.end());
  if (all.empty()) return;
  std::printf("\n|bias| / bound per axis, %d poses, %d draws: worst %.3f, median %.3f\n", poses,
              draws, all.back(), all[all.size() / 2]);
}

}  // namespace

int main(int argc, char** argv) {
  const auto argument = [&](int i, int fallback) {
    return argc > i ? std::atoi(argv[i]) : fallback;
  };
  const int images = argument(1, 200);
  print_bands(false, images);
  print_bands(true, images);
  print_bias(argument(2, 20), argument(3, 400));
  const Degraded d = measure_degraded(make_rig(true), 5 * images);
  std::printf(
      "\nenvelope, start 0.3 px off: %d frames, %d without result, 95 %% ellipsoid covers %.3f, "
      "high precision %.3f, worst rotation %.2f deg\n",
      d.frames, d.failed, d.covered, d.high_precision, d.worst_rotation_deg);
  return 0;
}
