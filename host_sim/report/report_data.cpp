#include "host_sim/report/report_data.hpp"

#include <algorithm>

namespace berth::host {
namespace {

double error_over_limit(const Verdict& verdict) {
  const double scale = verdict.distance_mm * verdict.distance_mm / (300.0 * 300.0);
  return std::max(verdict.rotation_deg / (0.015 * scale), verdict.translation_mm / (0.2 * scale));
}

bool is_worse(const WorstFrame& a, const WorstFrame& b) {
  if (a.badness != b.badness) return a.badness > b.badness;
  return a.entry.record.pose.frame_index < b.entry.record.pose.frame_index;
}

}  // namespace

double badness(const ReportEntry& entry) {
  const FrameRecord& record = entry.record;
  if (record.reason() == Reason::kBadFrame) return 0;
  const bool judged = entry.truth.has_value();
  if (judged && entry.verdict.false_pose) return 1e9;
  if (judged && entry.verdict.false_identification) return 1e8;
  if (entry.reference.disagrees()) return 1e7;
  if (judged && !entry.verdict.has_target) return 0;
  if (!record.identified()) return 1e6;
  const double error =
      judged && entry.verdict.has_error ? std::min(1e4, error_over_limit(entry.verdict)) : 0;
  if (!record.valid()) return 1e5 + error;
  return judged ? error : to_double(record.pose.residual_px);
}

void WorstFrames::offer(const ReportEntry& entry, const cv::Mat& image) {
  WorstFrame frame{entry, image, {}, badness(entry)};
  if (frame.badness <= 0 || image.empty()) return;
  if (kept_.size() == kKept && !is_worse(frame, kept_.back())) return;
  kept_.insert(std::upper_bound(kept_.begin(), kept_.end(), frame, is_worse), std::move(frame));
  if (kept_.size() > kKept) kept_.pop_back();
}

std::vector<WorstFrame> WorstFrames::take() { return std::move(kept_); }

}  // namespace berth::host
