// bench_circles [--count N] [--jobs N]: the ring's recall beside OpenCV's circle detectors and a
// randomized Hough transform, as the tables of docs/circles.md.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <opencv2/core/utility.hpp>

#include "bench/circles/conditions.hpp"
#include "bench/circles/detectors.hpp"
#include "bench/common/in_parallel.hpp"
#include "host_sim/io/camera_file.hpp"
#include "host_sim/render/render.hpp"

namespace berth::bench {
namespace {

struct FrameTally {
  bool is_found = false;
  int others = 0;
  double time_ms = 0;
  std::size_t bytes = 0;
};

using Row = std::vector<FrameTally>;  // one per detector

Row measure(const host::Scene& scene, const host::Camera& camera, const host::Target& target,
            const std::vector<CircleDetector>& detectors) {
  host::Image8 image = render_frame(scene, camera, target);
  const cv::Mat frame(image.height, image.width, CV_8U, image.data.data());
  const TrueCircles truth = true_circles(scene, camera, target);
  Row row;
  for (const CircleDetector& detector : detectors) {
    const CircleDetection detection = detector.detect(frame);
    FrameTally tally{false, 0, detection.time_ms, detection.bytes};
    for (const FoundCircle& circle : detection.circles) {
      const bool is_ring = is_one_of(circle, truth.ring);
      tally.is_found |= is_ring;
      tally.others += !is_ring && !is_one_of(circle, truth.dots);
    }
    row.push_back(tally);
  }
  return row;
}

// Rows of all conditions, one condition after the other.
std::vector<Row> measure_all(const std::vector<Condition>& conditions, int count, int jobs) {
  const host::Camera camera = host::default_camera();
  const host::Target target = host::default_target();
  std::vector<Row> rows(conditions.size() * static_cast<size_t>(count));
  in_parallel(static_cast<int>(rows.size()), jobs, "scenes", [&]() -> FrameWork {
    return [&, detectors = all_circle_detectors()](int index) {
      const Condition& condition = conditions[static_cast<size_t>(index / count)];
      const auto scene =
          make_scene(condition, static_cast<std::uint64_t>(index % count), camera, target);
      rows[static_cast<size_t>(index)] = measure(scene, camera, target, detectors);
    };
  });
  return rows;
}

void print_line(const std::string& first, const std::vector<std::string>& cells) {
  fmt::print("| {} |", first);
  for (const std::string& cell : cells) fmt::print(" {} |", cell);
  fmt::print("\n");
}

void print_recall(const std::vector<Condition>& conditions, const std::vector<Row>& rows, int count,
                  const std::vector<CircleDetector>& detectors) {
  std::vector<std::string> names;
  for (const CircleDetector& d : detectors) names.push_back(d.name);
  fmt::print("\nRing found, {} scenes per condition\n\n", count);
  print_line("scenes", names);
  print_line("---", std::vector<std::string>(names.size(), "---"));
  for (size_t c = 0; c < conditions.size(); ++c) {
    std::vector<std::string> cells;
    for (size_t d = 0; d < detectors.size(); ++d) {
      int found = 0;
      for (int i = 0; i < count; ++i) {
        found += rows[c * static_cast<size_t>(count) + static_cast<size_t>(i)][d].is_found;
      }
      cells.push_back(fmt::format("{:.1f} %", 100.0 * found / count));
    }
    print_line(conditions[c].name, cells);
  }
}

void print_costs(const std::vector<Row>& rows, const std::vector<CircleDetector>& detectors) {
  fmt::print(
      "\n| detector | ring found | other circles per frame | memory | time, median | worst |\n");
  fmt::print("| --- | --- | --- | --- | --- | --- |\n");
  for (size_t d = 0; d < detectors.size(); ++d) {
    double found = 0, others = 0;
    std::size_t bytes = 0;
    std::vector<double> times;
    for (const Row& row : rows) {
      found += row[d].is_found;
      others += row[d].others;
      bytes = std::max(bytes, row[d].bytes);
      times.push_back(row[d].time_ms);
    }
    std::sort(times.begin(), times.end());
    const double frames = static_cast<double>(rows.size());
    fmt::print("| {} | {:.1f} % | {:.1f} | {:.0f} KiB | {:.1f} ms | {:.0f} ms |\n",
               detectors[d].name, 100 * found / frames, others / frames,
               static_cast<double>(bytes) / 1024, times[times.size() / 2], times.back());
  }
}

// Indices of scenes whose ring a detector misses, to look at them one by one.
void print_misses(const std::vector<Condition>& conditions, const std::vector<Row>& rows, int count,
                  size_t detector) {
  for (size_t i = 0; i < rows.size(); ++i) {
    if (rows[i][detector].is_found) continue;
    const size_t n = static_cast<size_t>(count);
    const host::Scene s =
        make_scene(conditions[i / n], i % n, host::default_camera(), host::default_target());
    fmt::print(stderr,
               "missed: {}, scene {}: {:.0f} mm, {:.0f} deg, contrast {:.0f}, noise {:.1f}, "
               "defocus {:.1f}, motion {:.1f}, hidden '{}'\n",
               conditions[i / n].name, i % n, s.viewpoint.distance_mm, s.viewpoint.tilt_deg,
               s.contrast_dn(), s.noise_dn, s.optics.defocus_px, s.optics.motion_px,
               s.hidden_marker());
  }
}

}  // namespace
}  // namespace berth::bench

int main(int argc, char** argv) {
  using namespace berth::bench;
  int count = 100, jobs = 1, most = 1000;
  CLI::App app(
      "The ring's recall beside OpenCV's circle detectors, as the tables of docs/circles.md");
  app.add_option("--count", count, "scenes per condition")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  app.add_option("--jobs", jobs, "threads; times are clean with one only")->capture_default_str();
  app.add_option("--conditions", most, "only the first so many conditions");
  CLI11_PARSE(app, argc, argv);
  cv::setNumThreads(1);
  auto conditions = all_conditions();
  conditions.resize(std::min(conditions.size(), static_cast<size_t>(std::max(most, 1))));
  const auto detectors = all_circle_detectors();
  const auto rows = measure_all(conditions, count, jobs);
  print_recall(conditions, rows, count, detectors);
  print_costs(rows, detectors);
  print_misses(conditions, rows, count, 1);
  return 0;
}
