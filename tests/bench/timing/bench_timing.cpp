// bench_timing [Google Benchmark's options]: time per frame on the PC, one thread, of the whole
// chain, of its stages and of what OpenCV and AprilTag offer, on the same images in one run.
#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>
#include <benchmark/benchmark.h>

#include <chrono>
#include <memory>
#include <opencv2/aruco.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/ximgproc/edge_drawing.hpp>
#include <vector>

#include "app/parameter_block.hpp"
#include "common/view_of.hpp"
#include "host_sim/budget/hard_frames.hpp"
#include "host_sim/replay/setup.hpp"
#include "pipeline/pipeline.hpp"

namespace berth::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kFrames = 24;

const std::vector<host::NamedFrame>& frames() {
  static const auto rendered =
      host::envelope_frames(kFrames, host::default_camera(), host::default_target());
  return rendered;
}

// The frames one after the other, again and again. The counter is their number per second.
template <typename Work>
void time_frames(benchmark::State& state, Work work) {
  std::size_t i = 0;
  for (auto _ : state) work(frames()[i++ % frames().size()].image);
  state.SetItemsProcessed(static_cast<std::int64_t>(i));
}

const Parameters& flight_parameters() {
  static const auto parameters = [] {
    const auto setup = host::load_setup({});
    auto decoded = std::make_unique<Parameters>();
    decode_parameter_block({setup->parameter_block.data(), setup->parameter_block.size()},
                           *decoded);
    return decoded;
  }();
  return *parameters;
}

struct Chain {
  Workspace workspace;
  FrameResult result;
};

Chain& chain() {
  static const auto memory = std::make_unique<Chain>();
  return *memory;
}

void whole_frame(benchmark::State& state) {
  Chain& c = chain();
  time_frames(state, [&](const cv::Mat& image) {
    process_frame(flight_parameters(), view_of(image), {}, c.workspace, c.result);
    benchmark::DoNotOptimize(c.result);
  });
}

// Time that a frame spends in each stage.
class StageTimes {
 public:
  StageObserver observer() { return {&StageTimes::on_stage_end, this}; }
  void start_frame() {
    for (double& s : seconds_) s = 0;
    last_ = Clock::now();
  }
  double operator[](Stage stage) const { return seconds_[static_cast<int>(stage)]; }

 private:
  static void on_stage_end(void* context, Stage stage) {
    StageTimes& self = *static_cast<StageTimes*>(context);
    const auto now = Clock::now();
    self.seconds_[static_cast<int>(stage)] +=
        std::chrono::duration<double>(now - self.last_).count();
    self.last_ = now;
  }

  double seconds_[kStageCount] = {};
  Clock::time_point last_;
};

void one_stage(benchmark::State& state) {
  const auto stage = static_cast<Stage>(state.range(0));
  Chain& c = chain();
  StageTimes times;
  std::size_t i = 0;
  for (auto _ : state) {
    const cv::Mat& image = frames()[i++ % frames().size()].image;
    times.start_frame();
    process_frame(flight_parameters(), view_of(image), {}, c.workspace, c.result, times.observer());
    state.SetIterationTime(times[stage]);
  }
  state.SetLabel(stage_name(stage));
}

void canny(benchmark::State& state) {
  cv::Mat edges;
  time_frames(state, [&](const cv::Mat& image) { cv::Canny(image, edges, 50, 150); });
}

void edge_drawing(benchmark::State& state) {
  const auto drawing = cv::ximgproc::createEdgeDrawing();
  time_frames(state, [&](const cv::Mat& image) { drawing->detectEdges(image); });
}

void edge_drawing_ellipses(benchmark::State& state) {
  const auto drawing = cv::ximgproc::createEdgeDrawing();
  std::vector<cv::Vec6d> ellipses;
  time_frames(state, [&](const cv::Mat& image) {
    drawing->detectEdges(image);
    drawing->detectEllipses(ellipses);
  });
}

void hough_circles(benchmark::State& state) {
  std::vector<cv::Vec3f> circles;
  time_frames(state, [&](const cv::Mat& image) {
    cv::HoughCircles(image, circles, cv::HOUGH_GRADIENT, 2, 20, 150, 100, 20, 150);
  });
}

void aruco(benchmark::State& state) {
  const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_APRILTAG_36h11);
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<int> ids;
  time_frames(state, [&](const cv::Mat& image) {
    cv::aruco::detectMarkers(image, dictionary, corners, ids);
  });
}

void april_tag(benchmark::State& state) {
  const std::unique_ptr<apriltag_family_t, void (*)(apriltag_family_t*)> family(tag36h11_create(),
                                                                                tag36h11_destroy);
  const std::unique_ptr<apriltag_detector_t, void (*)(apriltag_detector_t*)> detector(
      apriltag_detector_create(), apriltag_detector_destroy);
  apriltag_detector_add_family(detector.get(), family.get());
  detector->quad_decimate = static_cast<float>(state.range(0));
  detector->nthreads = 1;
  time_frames(state, [&](const cv::Mat& image) {
    image_u8_t view{image.cols, image.rows, image.cols, image.data};
    apriltag_detections_destroy(apriltag_detector_detect(detector.get(), &view));
  });
}

void register_all() {
  const auto add = [](const char* name, void (*run)(benchmark::State&)) {
    return benchmark::RegisterBenchmark(name, run)->Unit(benchmark::kMillisecond);
  };
  add("Berthmark, whole frame", whole_frame);
  const auto stages = add("Berthmark, stage", one_stage)->UseManualTime();
  for (const Stage stage : {Stage::kEdges, Stage::kLink, Stage::kCircles, Stage::kIdentify,
                            Stage::kMarkers, Stage::kPose, Stage::kRefine}) {
    stages->Arg(static_cast<int>(stage));
  }
  add("Canny", canny);
  add("EdgeDrawing", edge_drawing);
  add("EdgeDrawing and ellipses", edge_drawing_ellipses);
  add("HoughCircles", hough_circles);
  add("ArUco", aruco);
  add("AprilTag 3, decimation", april_tag)->Arg(1)->Arg(2)->Arg(4);
}

}  // namespace
}  // namespace berth::bench

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  berth::bench::register_all();
  berth::bench::frames();
  benchmark::RunSpecifiedBenchmarks();
}
