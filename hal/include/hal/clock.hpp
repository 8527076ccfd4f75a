// Free-running clock, for platform facts (instruction counts, uptime) and nothing else: no result
// of a frame may depend on it.
#pragma once

#include <cstdint>

namespace berth::hal {

/// Starts the clock at zero.
void clock_start();

/// Ticks since clock_start(), at clock_rate_hz(). Never wraps. Cost: about 20 instructions.
std::uint64_t clock_ticks();

/// Ticks per second.
std::uint32_t clock_rate_hz();

}  // namespace berth::hal
