// The files that a replay writes frame by frame, and what it says on standard error.
#pragma once

#include <fstream>
#include <memory>
#include <ostream>
#include <string>
#include <tl/expected.hpp>

#include "host_sim/replay/frame_outcome.hpp"
#include "host_sim/replay/replay_options.hpp"

namespace berth::host {

/// "FILE: cannot be written; cure": the one line for every output that does not open.
std::string unwritable(const std::string& path);

class Outputs {
 public:
  /// Opens everything that `options` asks for, so that a path that cannot be written ends the run
  /// before its first frame. Without any output the poses go to standard output.
  static tl::expected<Outputs, std::string> open(const ReplayOptions& options);

  /// Writes a frame's rows.
  void write(const FrameOutcome& outcome);
  /// Flushes; the error names a file that could not be written to its end (disk full).
  tl::expected<void, std::string> close();

 private:
  struct File {
    std::string path;
    std::unique_ptr<std::ofstream> file;
    std::ostream* stream = nullptr;
  };
  static tl::expected<File, std::string> open_file(const std::string& path);

  bool reference_ = false;
  std::uint32_t period_us_ = 0;
  File poses_, markers_, tum_;
};

/// Lines on standard error about what was done to images, each kind once.
class Notes {
 public:
  void tell(const FrameOutcome& outcome);
  /// Clears the progress bar's line before a note is printed.
  bool on_terminal = false;

 private:
  void say(const std::string& line) const;
  void tell_problem(const FrameOutcome& outcome);
  bool said_16_bit_ = false, said_color_ = false;
  int problems_ = 0;
};

}  // namespace berth::host
