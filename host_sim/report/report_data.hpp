// Everything that the HTML report shows, gathered frame by frame.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/report/evaluate.hpp"
#include "host_sim/report/reference_comparison.hpp"
#include "host_sim/report/summary.hpp"

namespace berth::host {

struct ReportEntry {
  FrameRecord record;
  std::optional<TruthRow> truth;
  Verdict verdict;  // meaningful with a truth
  ReferenceComparison reference;
};

/// One of the frames that came out worst, with its overlay.
struct WorstFrame {
  ReportEntry entry;
  cv::Mat image;    // as the chain saw it
  cv::Mat picture;  // with the overlay
  double badness = 0;
};

struct ReportData {
  std::string title;
  std::string camera_name, target_name;
  bool on_target = false;
  bool with_reference = false;
  bool interrupted = false;
  Summary summary;
  std::vector<ReportEntry> entries;
  std::vector<WorstFrame> worst;  // worst first
};

/// How much a frame asks to be looked at: false poses first, then false identifications, then
/// disagreement with OpenCV, misses, poses that are not valid, and errors over their limit.
double badness(const ReportEntry& entry);

/// Keeps the images of the frames that are worst so far.
class WorstFrames {
 public:
  void offer(const ReportEntry& entry, const cv::Mat& image);
  /// Worst first.
  std::vector<WorstFrame> take();

 private:
  static constexpr std::size_t kKept = 12;
  std::vector<WorstFrame> kept_;
};

}  // namespace berth::host
