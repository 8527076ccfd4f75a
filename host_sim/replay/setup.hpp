// Camera, target and mounting of a replay, and the parameter block made of them.
#pragma once

#include <cstdint>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "host_sim/io/camera_file.hpp"
#include "host_sim/io/mount_file.hpp"
#include "host_sim/io/target_file.hpp"
#include "host_sim/replay/replay_options.hpp"

namespace berth::host {

struct Setup {
  Camera full_camera;  // as the file has it
  Camera camera;       // as the chain sees it: binned where it is larger than 1024 pixels
  int binning = 1;
  Target target;
  Mount mount;
  std::vector<std::uint8_t> parameter_block;
};

/// Reads the files that `options` names; the error is one line with file, key and cure.
tl::expected<Setup, std::string> load_setup(const ReplayOptions& options);

}  // namespace berth::host
