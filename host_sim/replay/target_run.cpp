#include "host_sim/replay/target_run.hpp"

#include <algorithm>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

#include "host_sim/on_target/on_target.hpp"
#include "host_sim/replay/frame_worker.hpp"

namespace berth::host {
namespace {

/// A frame that a board was given; its image is read again for drawing where it is a file.
struct Sent {
  FrameJob job;
  FrameOutcome outcome;
  bool is_answered = false;
};

class TargetRun {
 public:
  TargetRun(FrameSource& source, const Setup& setup, const ReplayOptions& options,
            const std::function<void()>& on_frame, const std::atomic<bool>& stop)
      : source_(source), setup_(setup), options_(options), on_frame_(on_frame), stop_(stop) {}

  void work() {
    FrameOutcome current;  // keeps the pixels that the board is reading
    const auto next = [&](TargetFrame& frame) { return send(current, frame); };
    std::vector<std::uint8_t> bytes;
    TargetOptions target;
    target.image = options_.firmware;
    target.on_bytes = [&](Span<const std::uint8_t> portion) {
      bytes.insert(bytes.end(), portion.begin(), portion.end());
    };
    const auto run =
        run_on_target(next, {setup_.parameter_block.data(), setup_.parameter_block.size()}, target);
    if (!run && !stop_) return fail(run.error());
    if (!run) bytes.resize(whole_packets(bytes));
    const auto telemetry = decode_telemetry(bytes);
    if (!telemetry) return stop_ ? void() : fail(telemetry.error());
    const std::lock_guard lock(mutex_);
    for (const FrameTelemetry& frame : telemetry->frames) answer(frame);
  }

  tl::expected<void, std::string> deliver(const std::function<void(FrameOutcome)>& deliver) {
    if (!error_.empty()) return tl::unexpected(error_);
    for (auto& [index, sent] : sent_) {
      if (!sent.is_answered) {
        if (stop_) break;
        return tl::unexpected(sent.job.name + ": the firmware sent no packets for this frame");
      }
      FrameOutcome outcome = read_frame(sent.job, setup_);
      outcome.record = std::move(sent.outcome.record);
      finish_frame(outcome, nullptr, setup_, options_);
      deliver(std::move(outcome));
    }
    return {};
  }

 private:
  static std::size_t whole_packets(const std::vector<std::uint8_t>& bytes) {
    const auto last_zero = std::find(bytes.rbegin(), bytes.rend(), std::uint8_t{0});
    return static_cast<std::size_t>(bytes.rend() - last_zero);
  }

  bool send(FrameOutcome& current, TargetFrame& frame) {
    std::optional<FrameJob> job;
    {
      const std::lock_guard lock(mutex_);
      if (!stop_ && error_.empty()) job = source_.next();
      if (!job) return false;
    }
    current = read_frame(*job, setup_);
    frame.index = static_cast<std::uint32_t>(job->index);
    frame.mid_exposure_us = std::uint64_t{job->index} * options_.period_us;
    frame.width = current.image.cols;
    frame.height = current.image.rows;
    frame.pixels = {current.image.data, current.image.total()};
    on_frame_();
    const std::lock_guard lock(mutex_);
    Sent& sent = sent_[job->index];
    sent.outcome.record.file = job->name;
    sent.job = std::move(*job);
    return true;
  }

  void answer(const FrameTelemetry& frame) {
    const auto sent = sent_.find(frame.pose.frame_index);
    if (sent == sent_.end()) return;
    static_cast<FrameTelemetry&>(sent->second.outcome.record) = frame;
    sent->second.is_answered = true;
  }

  void fail(const std::string& error) {
    const std::lock_guard lock(mutex_);
    if (error_.empty()) error_ = error;
  }

  FrameSource& source_;
  const Setup& setup_;
  const ReplayOptions& options_;
  const std::function<void()>& on_frame_;
  const std::atomic<bool>& stop_;
  std::mutex mutex_;
  std::map<std::size_t, Sent> sent_;
  std::string error_;
};

}  // namespace

tl::expected<void, std::string> run_frames_on_target(
    FrameSource& source, const Setup& setup, const ReplayOptions& options,
    const std::function<void()>& on_frame, const std::function<void(FrameOutcome)>& deliver,
    const std::atomic<bool>& stop) {
  TargetRun run(source, setup, options, on_frame, stop);
  const std::size_t frames = source.total().value_or(256);
  const int boards = static_cast<int>(std::min<std::size_t>(options.jobs, frames));
  std::vector<std::thread> threads;
  for (int i = 0; i < boards; ++i) threads.emplace_back([&run] { run.work(); });
  for (std::thread& thread : threads) thread.join();
  return run.deliver(deliver);
}

}  // namespace berth::host
