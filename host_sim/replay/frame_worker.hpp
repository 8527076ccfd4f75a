// One worker's way from a frame's file to its outcome.
#pragma once

#include "host_sim/replay/frame_outcome.hpp"
#include "host_sim/replay/frame_source.hpp"
#include "host_sim/replay/parallel.hpp"
#include "host_sim/replay/replay_options.hpp"
#include "host_sim/replay/setup.hpp"
#include "host_sim/report/trace.hpp"

namespace berth::host {

/// The frame's image as the chain takes it (read, converted, binned), or its problem; the record
/// holds the file's name only.
FrameOutcome read_frame(const FrameJob& job, const Setup& setup);

/// Where the overlay of a frame goes: its name with folders' slashes made underscores, as PNG.
std::filesystem::path overlay_path(const std::string& folder, const std::string& name);

/// What `options` ask for beyond the packets: OpenCV's pose beside ours, and the overlay picture
/// (`trace` is null where the stages' results are not at hand). Throws where it cannot be written.
void finish_frame(FrameOutcome& outcome, const Trace* trace, const Setup& setup,
                  const ReplayOptions& options);

/// A worker that runs the flight code in this process, with a memory of its own. `setup` and
/// `options` must outlive it.
FrameWork make_chain_worker(const Setup& setup, const ReplayOptions& options);

}  // namespace berth::host
