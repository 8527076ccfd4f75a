// bench_edges [--count N] [--jobs N] [--photos FOLDER]: our edges beside OpenCV's, as the tables of
// docs/edges.md.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <opencv2/core/utility.hpp>

#include "bench/common/in_parallel.hpp"
#include "bench/common/photographs.hpp"
#include "bench/edges/detectors.hpp"
#include "bench/edges/truth.hpp"
#include "host_sim/io/camera_file.hpp"
#include "host_sim/render/render.hpp"
#include "host_sim/render/sample_scene.hpp"

namespace berth::bench {
namespace {

constexpr int kSide_px = 1024;
constexpr std::uint64_t kSeed = 3;

struct FrameTally {
  TruthTally truth;
  Mean blocks, turning;
  double pixels = 0, steps = 0;
  std::vector<double> times_ms;

  void add(const Detection& d) {
    blocks.merge(block_share(d));
    turning.merge(turning_deg(d));
    for (const PixelChain& chain : d.chains) pixels += static_cast<double>(chain.pixels.size());
    steps += d.steps;
    times_ms.push_back(d.time_ms);
  }
  void merge(const FrameTally& other) {
    truth.merge(other.truth);
    blocks.merge(other.blocks);
    turning.merge(other.turning);
    pixels += other.pixels;
    steps += other.steps;
    times_ms.insert(times_ms.end(), other.times_ms.begin(), other.times_ms.end());
  }
};

// One per detector; on renders also the outlines themselves.
using Row = std::vector<FrameTally>;

// Sums in the frames' order, so that the result does not depend on the number of threads.
Row merge(const std::vector<Row>& frames) {
  Row sum(frames.empty() ? 0 : frames[0].size());
  for (const Row& frame : frames) {
    for (size_t d = 0; d < sum.size(); ++d) sum[d].merge(frame[d]);
  }
  return sum;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

Row measure(const cv::Mat& image, const std::vector<Detector>& detectors,
            const std::vector<TrueContour>* contours) {
  Row row;
  for (const Detector& detector : detectors) {
    const Detection detection = detector.detect(image);
    FrameTally tally;
    tally.add(detection);
    if (contours) tally.truth = compare(detection, *contours);
    row.push_back(std::move(tally));
  }
  if (!contours) return row;
  row.emplace_back();
  row.back().truth = compare(round_outlines(*contours, image.size()), *contours);
  return row;
}

Row measure_renders(int count, int jobs) {
  const host::Camera camera = host::default_camera();
  const host::Target target = host::default_target();
  std::vector<Row> frames(static_cast<size_t>(count));
  in_parallel(count, jobs, "renders", [&]() -> FrameWork {
    return [&, detectors = all_detectors()](int index) {
      host::SceneOptions options;
      options.seed = kSeed;
      const host::Scene scene =
          sample_scene(options, static_cast<std::uint64_t>(index), camera, target);
      host::Image8 image = render_frame(scene, camera, target);
      const auto contours = true_contours(scene, camera, target);
      frames[static_cast<size_t>(index)] =
          measure({image.height, image.width, CV_8U, image.data.data()}, detectors, &contours);
    };
  });
  return merge(frames);
}

Row measure_photographs(const std::vector<Photograph>& photographs, int jobs) {
  std::vector<Row> frames(photographs.size());
  in_parallel(static_cast<int>(photographs.size()), jobs, "photographs", [&]() -> FrameWork {
    return [&, detectors = all_detectors()](int index) {
      const size_t i = static_cast<size_t>(index);
      frames[i] = measure(photographs[i].crop, detectors, nullptr);
    };
  });
  return merge(frames);
}

std::string common_columns(const FrameTally& t, int frames) {
  return fmt::format("{:.2f} % | {:.2f} | {:.2f} | {:.0f} | {:.1f} ms", 100 * t.blocks.value(),
                     t.turning.value(), t.steps / std::max(t.pixels, 1.0), t.pixels / frames,
                     median(t.times_ms));
}

void print_whole_frames(const char* name, const Row& row, int frames) {
  const auto detectors = all_detectors();
  fmt::print(
      "\n| {} {}, whole frames | in 2 x 2 blocks | turning, deg per pixel | steps per pixel | "
      "pixels | time |\n| --- | --- | --- | --- | --- | --- |\n",
      frames, name);
  for (size_t d = 0; d < detectors.size(); ++d) {
    fmt::print("| {} | {} |\n", detectors[d].name, common_columns(row[d], frames));
  }
}

std::string truth_columns(const TruthTally& t) {
  return fmt::format(
      "{:.1f} % | {:.2f} px | {:.2f} px | {:.2f} px | {:.2f} px | {:.2f} | {:.2f} | {:.2f}",
      100 * t.found.value(), t.places.mean.value(), t.places.quantile(0.95), t.pixels.mean.value(),
      t.pixels.quantile(0.95), t.pieces.value(), t.turning.value(), t.turning_of_places.value());
}

void print_renders(const Row& row, int frames) {
  const auto detectors = all_detectors();
  fmt::print("\n{} rendered scenes of the envelope, seed {}\n\n", frames, kSeed);
  fmt::print(
      "| on the true outlines | found | distance, mean | p95 | of pixel centres, mean | p95 | "
      "pieces | turning, deg per pixel | of places |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
  for (size_t d = 0; d < detectors.size(); ++d) {
    fmt::print("| {} | {} |\n", detectors[d].name, truth_columns(row[d].truth));
  }
  fmt::print("| the outlines, rounded to pixels | {} |\n", truth_columns(row.back().truth));
  print_whole_frames("rendered scenes", row, frames);
}

}  // namespace
}  // namespace berth::bench

int main(int argc, char** argv) {
  using namespace berth::bench;
  int count = 400, jobs = 1;
  std::string folder = "/usr/share/wallpapers";
  CLI::App app("Our edges beside OpenCV's EdgeDrawing and Canny, as the tables of docs/edges.md");
  app.add_option("--count", count, "rendered scenes")->capture_default_str();
  app.add_option("--jobs", jobs, "threads; times are clean with one only")->capture_default_str();
  app.add_option("--photos", folder, "folder of photographs")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  cv::setNumThreads(1);
  print_renders(measure_renders(count, jobs), count);
  const auto photographs = photograph_crops(folder, kSide_px);
  if (photographs.empty()) {
    fmt::print(
        "\nno photographs in {}: install Debian's plasma-workspace-wallpapers for the second "
        "table\n",
        folder);
    return 0;
  }
  print_whole_frames("photographs", measure_photographs(photographs, jobs),
                     static_cast<int>(photographs.size()));
  return 0;
}
