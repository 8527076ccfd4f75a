#include "host_sim/replay/replay.hpp"

#include <fmt/format.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <string>

#include "host_sim/replay/frame_source.hpp"
#include "host_sim/replay/frame_worker.hpp"
#include "host_sim/replay/outputs.hpp"
#include "host_sim/replay/parallel.hpp"
#include "host_sim/replay/progress.hpp"
#include "host_sim/replay/report_writer.hpp"
#include "host_sim/replay/setup.hpp"
#include "host_sim/replay/target_run.hpp"
#include "host_sim/replay/truth_lookup.hpp"
#include "host_sim/report/summary.hpp"

namespace berth::host {
namespace {

constexpr int kDone = 0;
constexpr int kCheckFailed = 1;
constexpr int kWrongUsage = 2;
constexpr int kInterrupted = 130;  // as shells have it

std::atomic<bool> stop_requested{false};

/// Ctrl-C ends the run after the frames begun; a second one ends the program.
void on_interrupt(int) {
  stop_requested = true;
  std::signal(SIGINT, SIG_DFL);
}

int refuse(const std::string& line) {
  std::fprintf(stderr, "berthmark: %s\n", line.c_str());
  return kWrongUsage;
}

/// What is left to do with a frame's outcome, in the frames' order.
class Collector {
 public:
  Collector(Outputs& outputs, ReportWriter& report, const TruthLookup& truth, const Setup& setup,
            Progress& progress)
      : outputs_(outputs), report_(report), truth_(truth), setup_(setup), progress_(progress) {
    notes_.on_terminal = progress.on_terminal();
  }

  void take(const FrameOutcome& outcome) {
    notes_.tell(outcome);
    outputs_.write(outcome);
    readable_ += outcome.problem.empty();
    disagreeing_ += outcome.reference.disagrees();
    summary_.add(outcome.record);
    const TruthRow* truth = truth_.empty() ? nullptr : truth_.find(outcome.path);
    Verdict verdict;
    if (truth) {
      verdict = judge(outcome.record, *truth, setup_.camera, setup_.target);
      summary_.add(outcome.record, verdict);
    }
    report_.take(outcome, truth, verdict);
    progress_.show(summary_.frames, summary_.valid);
  }

  const Summary& summary() const { return summary_; }
  std::size_t readable() const { return readable_; }
  std::size_t disagreeing() const { return disagreeing_; }

 private:
  Outputs& outputs_;
  ReportWriter& report_;
  const TruthLookup& truth_;
  const Setup& setup_;
  Progress& progress_;
  Notes notes_;
  Summary summary_;
  std::size_t readable_ = 0, disagreeing_ = 0;
};

int finish(Collector& collector, Outputs& outputs, const ReplayOptions& options) {
  if (const auto closed = outputs.close(); !closed) return refuse(closed.error());
  if (options.summary) std::fputs(summary_text(collector.summary()).c_str(), stdout);
  if (stop_requested) {
    refuse(fmt::format("interrupted; {} frames are written", collector.summary().frames));
    return kInterrupted;
  }
  if (collector.readable() == 0) return kWrongUsage;  // each frame has had its line
  if (collector.disagreeing() != 0) {
    std::fprintf(stderr,
                 "berthmark: %zu frames differ from OpenCV's pose by more than three sigma; see "
                 "the columns diff_r_deg and diff_t_mm\n",
                 collector.disagreeing());
    return kCheckFailed;
  }
  return kDone;
}

}  // namespace

int run_replay(const ReplayOptions& options) {
  const auto setup = load_setup(options);
  if (!setup) return refuse(setup.error());
  auto source = FrameSource::open(options.paths);
  if (!source) return refuse(source.error());
  const auto truth = TruthLookup::open(options.truth, source->folders());
  if (!truth) return refuse(truth.error());
  auto outputs = Outputs::open(options);
  if (!outputs) return refuse(outputs.error());
  auto report = ReportWriter::open(options);
  if (!report) return refuse(report.error());
  if (setup->binning != 1) {
    std::fprintf(stderr, "berthmark: camera of %d x %d: images are binned %d x %d (said once)\n",
                 setup->full_camera.width, setup->full_camera.height, setup->binning,
                 setup->binning);
  }
  std::signal(SIGINT, on_interrupt);
  Progress progress(source->total());
  Collector collector(*outputs, *report, *truth, *setup, progress);
  const auto take = [&](const FrameOutcome& outcome) { collector.take(outcome); };
  if (options.on_target) {
    std::atomic<std::size_t> sent{0};
    const auto run = run_frames_on_target(
        *source, *setup, options, [&] { progress.show(++sent, 0); }, take, stop_requested);
    if (!run) return refuse(run.error());
  } else {
    run_in_order(
        *source, options.jobs, [&] { return make_chain_worker(*setup, options); }, take,
        stop_requested);
  }
  if (const auto written = report->write(*setup, options, collector.summary(), stop_requested);
      !written) {
    return refuse(written.error());
  }
  return finish(collector, *outputs, options);
}

}  // namespace berth::host
