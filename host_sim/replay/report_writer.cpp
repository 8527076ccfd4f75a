#include "host_sim/replay/report_writer.hpp"

#include "host_sim/replay/chain.hpp"
#include "host_sim/replay/outputs.hpp"
#include "host_sim/report/html_report.hpp"
#include "host_sim/report/overlay.hpp"

namespace berth::host {
namespace {

/// Overlays of the kept frames. On the PC their trace comes from running them once more; of a run
/// on target only the packets are known.
void draw(std::vector<WorstFrame>& worst, const Setup& setup, const ReplayOptions& options) {
  const OverlayScene scene{setup.camera, setup.target};
  Chain chain(setup.parameter_block);
  for (WorstFrame& frame : worst) {
    Trace trace;
    if (!options.on_target) {
      chain.run(frame.image, frame.entry.record.pose.frame_index, options.period_us);
      trace = read_trace(chain.workspace());
    }
    frame.picture =
        draw_overlay(frame.image, frame.entry.record, options.on_target ? nullptr : &trace, scene);
  }
}

}  // namespace

tl::expected<ReportWriter, std::string> ReportWriter::open(const ReplayOptions& options) {
  ReportWriter writer;
  writer.path_ = options.report;
  if (options.report.empty()) return writer;
  writer.file_.open(options.report, std::ios::binary | std::ios::trunc);
  if (!writer.file_) return tl::unexpected(unwritable(options.report));
  return writer;
}

void ReportWriter::take(const FrameOutcome& outcome, const TruthRow* truth,
                        const Verdict& verdict) {
  if (path_.empty()) return;
  ReportEntry entry{outcome.record, {}, verdict, outcome.reference};
  if (truth) entry.truth = *truth;
  worst_.offer(entry, outcome.image);
  data_.entries.push_back(std::move(entry));
}

tl::expected<void, std::string> ReportWriter::write(const Setup& setup,
                                                    const ReplayOptions& options,
                                                    const Summary& summary, bool interrupted) {
  if (path_.empty()) return {};
  data_.title = "Berthmark replay: " + options.paths.front();
  if (options.paths.size() > 1) {
    data_.title += " and " + std::to_string(options.paths.size() - 1) + " more";
  }
  data_.camera_name = setup.camera.name;
  data_.target_name = setup.target.name;
  data_.on_target = options.on_target;
  data_.with_reference = options.reference;
  data_.interrupted = interrupted;
  data_.summary = summary;
  data_.worst = worst_.take();
  draw(data_.worst, setup, options);
  file_ << html_report(data_);
  file_.flush();
  if (!file_)
    return tl::unexpected(path_ + ": could not be written to its end; make room on the disk");
  return {};
}

}  // namespace berth::host
