// Runs the built program as a user does, in a folder of its own.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace berth::host {

struct Outcome {
  int exit_code = -1;
  std::string out, err;

  /// Lines on standard error.
  int error_lines() const;
};

/// A folder that lives as long as the object.
class Workplace {
 public:
  Workplace();
  ~Workplace();
  Workplace(const Workplace&) = delete;
  Workplace& operator=(const Workplace&) = delete;

  /// Runs `berthmark ARGUMENTS` by the shell, in this folder; `environment` goes before it.
  Outcome run(const std::string& arguments, const std::string& environment = "") const;

  std::filesystem::path path(const std::string& name) const { return folder_ / name; }
  void write(const std::string& name, const std::string& text) const;
  std::string read(const std::string& name) const;
  /// A plain grey image of the default camera's size, or another one.
  void write_image(const std::string& name, cv::Size size = {1024, 1024}, int type = CV_8UC1) const;

 private:
  std::filesystem::path folder_;
};

/// A text's lines, without the line ends.
std::vector<std::string> lines_of(const std::string& text);
/// A line's fields between commas.
std::vector<std::string> fields_of(const std::string& line);

}  // namespace berth::host
