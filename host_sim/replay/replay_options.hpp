// What the command line of `berthmark replay` says.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace berth::host {

struct ReplayOptions {
  std::vector<std::string> paths;
  // Inputs; empty: HEC-1, CT-1, identity, a truth.csv lying beside the images.
  std::string camera, target, mount, truth;
  // Outputs; empty: not written. "-" is standard output for `poses`.
  std::string poses, markers, tum, overlay, report;
  std::uint32_t period_us = 125000;
  int jobs = 1;
  bool summary = false;
  bool reference = false;
  bool track = false;
  bool on_target = false;
  std::string firmware;  // image for `on_target`; empty: beside this program
};

}  // namespace berth::host
