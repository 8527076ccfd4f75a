// Rows computed on several threads, delivered in order.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

namespace berth::host {

/// Turns an index into its row; made once per thread, so that it can own its memory.
using RowWork = std::function<std::string(uint64_t)>;

/// Rows `first` to `end` - 1 by `jobs` threads. `deliver` is called on the caller's thread, in
/// order, without gaps; it ends the run by returning false. When `stop` becomes true no further row
/// is begun, and those begun are delivered. A thread's exception comes out here.
void run_rows(uint64_t first, uint64_t end, int jobs, const std::function<RowWork()>& make_worker,
              const std::function<bool(const std::string&)>& deliver,
              const std::atomic<bool>& stop);

}  // namespace berth::host
