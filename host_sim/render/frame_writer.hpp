// Renders a sequence of frames to PNG files and truth.csv, on several threads.
#pragma once

#include <string>
#include <tl/expected.hpp>

#include "host_sim/render/render.hpp"
#include "host_sim/render/sample_scene.hpp"

namespace berth::host {

struct RenderJob {
  SceneOptions options;
  int count = 0;
  std::string folder;
  int threads = 1;
  Camera camera;
  Target target;
};

/// Writes img_000000.png ... and truth.csv; the files do not depend on the number of threads. The
/// error is one line with the cause and the cure.
tl::expected<void, std::string> write_frames(const RenderJob& job);

}  // namespace berth::host
