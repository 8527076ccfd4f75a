// Progress bar on standard error, where that is a terminal.
#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <optional>

namespace berth::host {

class Progress {
 public:
  explicit Progress(std::optional<std::size_t> total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Draws at most ten times a second; from any thread.
  void show(std::size_t done, std::size_t valid);
  bool on_terminal() const { return on_terminal_; }

 private:
  using Clock = std::chrono::steady_clock;
  std::optional<std::size_t> total_;
  bool on_terminal_;
  std::mutex mutex_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point shown_ = start_;
};

}  // namespace berth::host
