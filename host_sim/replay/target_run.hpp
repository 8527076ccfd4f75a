// A replay through the firmware in QEMU instead of in this process.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <tl/expected.hpp>

#include "host_sim/replay/frame_outcome.hpp"
#include "host_sim/replay/frame_source.hpp"
#include "host_sim/replay/replay_options.hpp"
#include "host_sim/replay/setup.hpp"

namespace berth::host {

/// Runs every frame of `source` on `options.jobs` emulated boards and then delivers the outcomes in
/// order on the caller's thread, images included. `on_frame` is told, from any thread, of each
/// frame that a board has taken. When `stop` becomes true what is done is delivered. Error: one
/// line that says what is wrong with QEMU or the firmware image, and the cure.
tl::expected<void, std::string> run_frames_on_target(
    FrameSource& source, const Setup& setup, const ReplayOptions& options,
    const std::function<void()>& on_frame, const std::function<void(FrameOutcome)>& deliver,
    const std::atomic<bool>& stop);

}  // namespace berth::host
