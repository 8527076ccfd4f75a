// Precision against the Cramer-Rao bound, in full; `bench_accuracy --help`.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "accuracy/clean_campaign.hpp"
#include "accuracy/envelope_campaign.hpp"
#include "accuracy/tag_campaign.hpp"

namespace {

using namespace berth::accuracy;
namespace host = berth::host;

constexpr double kDistances_mm[] = {300, 500, 800, 1100, 1500};

void print_band(const char* name, double distance_mm, const Band& b) {
  std::printf("%-16s %5.0f  %8.3f  %11.3f  %6.3f  %8.5f  %8.5f  %6d\n", name, distance_mm,
              b.rotation, b.translation, b.nees, b.rotation_deg, b.translation_mm, b.failed);
}

void print_band_header(const char* title, int images) {
  std::printf("\n%s, tilt 0 to 40 deg, %d images each: rms error / bound\n", title, images);
  std::printf(
      "                    mm  rotation  translation  NEES/6   rms deg    rms mm  failed\n");
}

void print_clean(int images, Ledger& ledger) {
  print_band_header("clean images", images);
  for (const bool distorted : {false, true}) {
    const Rig rig = make_rig(distorted);
    for (const double d : kDistances_mm) {
      print_band(distorted ? "HEC-1" : "no distortion", d, measure_band(rig, d, images, ledger));
    }
  }
}

// Images that the estimator's own model did not make.
std::vector<Variant> other_models() {
  const auto turn = [](int i) { return 2.4 * i; };
  return {
      {"box psf", [](host::Scene& s, int) { s.optics.psf = host::PsfKind::kBox; }, 0},
      {"disc psf",
       [](host::Scene& s, int) {
         s.optics.psf = host::PsfKind::kDisc;
         s.optics.defocus_px = 1.2;
       },
       0},
      {"motion 4 px",
       [=](host::Scene& s, int i) {
         s.optics.motion_px = 4;
         s.optics.motion_angle_rad = turn(i);
       },
       0},
      {"light 3:1",
       [=](host::Scene& s, int i) {
         s.light.gradient_ratio = 3;
         s.light.gradient_angle_rad = turn(i);
       },
       0},
      {"gamma 0.8", [](host::Scene& s, int) { s.optics.gamma = 0.8; }, 0},
      {"gamma 1.2", [](host::Scene& s, int) { s.optics.gamma = 1.2; }, 0},
      {"white 300", [](host::Scene& s, int) { s.light.white_dn = 300; }, 0},
      {"photon noise", [](host::Scene& s, int) { s.noise_dn = 1; }, 40},
  };
}

void print_models(int images, Ledger& ledger) {
  print_band_header("other models, HEC-1", images);
  const Rig rig = make_rig(true);
  for (const Variant& v : other_models()) {
    for (const double d : {300.0, 800.0, 1500.0}) {
      print_band(v.name.c_str(), d, measure_band(rig, d, images, ledger, v));
    }
  }
}

void print_bias(int poses, int draws, Ledger& ledger) {
  const Rig rig = make_rig(false);
  std::vector<double> all;
  for (int i = 0; i < poses; ++i) {
    const Vector6 bias = measure_bias(rig, i, draws, ledger);
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

void print_tags(int images, Ledger& ledger) {
  const Rig rig = make_rig(false);  // readers of tags take edges as straight
  std::printf("\ntags on the same plate, clean images, %d each: rms error (over its own bound)\n",
              images);
  std::printf("tilt     mm  reader            rotation deg        translation mm      missed\n");
  for (const TiltBand& tilt : {TiltBand{0, 10}, TiltBand{10, 25}, TiltBand{25, 40}}) {
    for (const double d : kDistances_mm) {
      for (const ReaderScore& s : compare_readers(rig, tilt, d, images, ledger)) {
        std::printf("%2.0f-%2.0f  %5.0f  %-15s  %8.5f (%7.1f)  %8.5f (%7.1f)  %6d\n", tilt.from_deg,
                    tilt.to_deg, d, s.name, s.rotation_deg, s.rotation_over_bound, s.translation_mm,
                    s.translation_over_bound, s.missed);
      }
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Precision of the pose against the Cramer-Rao bound."};
  int images = 200, poses = 20, draws = 400, frames = 20000, tags = 20;
  std::string part = "all", state;
  app.add_option("--part", part, "clean, bias, models, envelope, tags or all")
      ->capture_default_str();
  app.add_option("--images", images, "images per distance")->capture_default_str();
  app.add_option("--poses", poses, "poses for the bias")->capture_default_str();
  app.add_option("--draws", draws, "noise draws per pose")->capture_default_str();
  app.add_option("--frames", frames, "frames of the envelope")->capture_default_str();
  app.add_option("--tags", tags, "images per distance and band of tilt, with tags")
      ->capture_default_str();
  app.add_option("--state", state, "file of results so far: an interrupted run goes on from it");
  CLI11_PARSE(app, argc, argv);
  Ledger ledger = state.empty() ? Ledger() : Ledger(state);
  const auto has = [&](const char* name) { return part == "all" || part == name; };
  if (has("clean")) print_clean(images, ledger);
  if (has("bias")) print_bias(poses, draws, ledger);
  if (has("models")) print_models(images, ledger);
  if (has("envelope")) print_envelope(frames, ledger);
  if (has("tags")) print_tags(tags, ledger);
  return 0;
}
