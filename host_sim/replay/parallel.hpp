// Frames through a number of worker threads, results in the frames' order.
#pragma once

#include <atomic>
#include <functional>

#include "host_sim/replay/frame_outcome.hpp"
#include "host_sim/replay/frame_source.hpp"

namespace berth::host {

/// What a worker thread does with a frame; made once per thread, so that it can own its memory.
using FrameWork = std::function<FrameOutcome(FrameJob)>;

/// Runs every frame of `source` through `jobs` workers. `deliver` is called on the caller's thread,
/// in order, without gaps. When `stop` becomes true no further frame is begun, and those begun are
/// delivered. At most a few frames per worker are in memory. An exception of a worker or of
/// `deliver` ends the run and comes out here.
void run_in_order(FrameSource& source, int jobs, const std::function<FrameWork()>& make_worker,
                  const std::function<void(FrameOutcome)>& deliver, const std::atomic<bool>& stop);

}  // namespace berth::host
