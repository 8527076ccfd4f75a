// Gathers what the HTML report of a replay shows, and writes it at the end.
#pragma once

#include <fstream>
#include <string>
#include <tl/expected.hpp>

#include "host_sim/replay/frame_outcome.hpp"
#include "host_sim/replay/replay_options.hpp"
#include "host_sim/replay/setup.hpp"
#include "host_sim/report/report_data.hpp"

namespace berth::host {

class ReportWriter {
 public:
  /// Opens the report's file, so that a path that cannot be written ends the run at its start.
  /// Without --report everything below does nothing.
  static tl::expected<ReportWriter, std::string> open(const ReplayOptions& options);

  void take(const FrameOutcome& outcome, const TruthRow* truth, const Verdict& verdict);

  /// Draws the worst frames and writes the file. The error names it.
  tl::expected<void, std::string> write(const Setup& setup, const ReplayOptions& options,
                                        const Summary& summary, bool interrupted);

 private:
  std::string path_;
  std::ofstream file_;
  ReportData data_;
  WorstFrames worst_;
};

}  // namespace berth::host
