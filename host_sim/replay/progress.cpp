#include "host_sim/replay/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <string>

namespace berth::host {

Progress::Progress(std::optional<std::size_t> total)
    : total_(total), on_terminal_(isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
  if (on_terminal_) std::fputs("\r\033[K", stderr);
}

void Progress::show(std::size_t done, std::size_t valid) {
  using Seconds = std::chrono::duration<double>;
  const std::lock_guard lock(mutex_);
  const Clock::time_point now = Clock::now();
  if (!on_terminal_ || now - shown_ < std::chrono::milliseconds(100)) return;
  shown_ = now;
  const double per_second = static_cast<double>(done) / Seconds(now - start_).count();
  if (!total_) {
    fmt::print(stderr, "\r\033[K{} frames, {} valid, {:.1f} per second", done, valid, per_second);
  } else {
    constexpr std::size_t kWidth = 40;
    const std::size_t bar = std::min(kWidth, kWidth * done / std::max<std::size_t>(*total_, 1));
    const double left_s = static_cast<double>(*total_ - done) / std::max(per_second, 1e-9);
    fmt::print(stderr, "\r\033[K[{}{}] {}/{}, {} valid, {:.1f} per second, {:.0f} s left",
               std::string(bar, '#'), std::string(kWidth - bar, '.'), done, *total_, valid,
               per_second, left_s);
  }
  std::fflush(stderr);
}

}  // namespace berth::host
