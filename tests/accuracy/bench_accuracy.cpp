// Precision against the Cramer-Rao bound, in full; `bench_accuracy --help`.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "accuracy/clean_campaign.hpp"
#include "accuracy/envelope_campaign.hpp"

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

void print_summary(const char* name, const EnvelopeSummary& s) {
  std::printf("%-12s %6d %6d  %7.2f %7.2f  %7.3f   %6.2f %6.2f   %6.2f (%d)\n", name, s.frames,
              s.failed, s.nees, s.nees_median, s.covered, 100 * s.precise, 100 * s.precise_at_bound,
              100 * s.precise_well_conditioned, s.well_conditioned);
}

void print_envelope(int frames, Ledger& ledger) {
  const auto all = measure_envelope(make_rig(true), 43, frames, ledger);
  std::printf("\nenvelope, start 0.3 px off\n");
  std::printf(
      "mm           frames failed   NEES/6  median  covered  precise  bound   well-cond.\n");
  print_summary("all", summarise(all));
  print_summary("300-450", summarise(all, 0, 450));
  print_summary("450-700", summarise(all, 450, 700));
  print_summary("700-1000", summarise(all, 700, 1000));
  print_summary("1000-1500", summarise(all, 1000));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Precision of the pose against the Cramer-Rao bound."};
  int images = 200, poses = 20, draws = 400, frames = 1000;
  std::string part = "all", state;
  app.add_option("--part", part, "clean, bias, envelope or all")->capture_default_str();
  app.add_option("--images", images, "images per distance")->capture_default_str();
  app.add_option("--poses", poses, "poses for the bias")->capture_default_str();
  app.add_option("--draws", draws, "noise draws per pose")->capture_default_str();
  app.add_option("--frames", frames, "frames of the envelope")->capture_default_str();
  app.add_option("--state", state, "file of results so far: an interrupted run goes on from it");
  CLI11_PARSE(app, argc, argv);
  Ledger ledger = state.empty() ? Ledger() : Ledger(state);
  const auto has = [&](const char* name) { return part == "all" || part == name; };
  if (has("clean")) {
    print_bands(false, images);
    print_bands(true, images);
  }
  if (has("bias")) print_bias(poses, draws);
  if (has("envelope")) print_envelope(frames, ledger);
  return 0;
}
