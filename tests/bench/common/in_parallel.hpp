// Frames on several threads, with progress on standard error.
#pragma once

#include <functional>

namespace berth::bench {

/// The work of one thread on frame `index`; made once per thread, so that it owns its memory.
using FrameWork = std::function<void(int index)>;

/// Calls a worker for 0 .. count - 1. Which thread has which frame is open: workers keep results by
/// index.
void in_parallel(int count, int jobs, const char* name, const std::function<FrameWork()>& make);

}  // namespace berth::bench
