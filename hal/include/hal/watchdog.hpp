// Watchdog: first time-out is an interrupt that leaves a fault record, the second one a reset.
#pragma once

#include <cstdint>

namespace berth::hal {

/// Starts it; it cannot be stopped again. timeout_us: 1 .. 100,000,000.
void watchdog_start(std::uint32_t timeout_us);

/// Called once per frame by the task that must not hang.
void watchdog_service();

}  // namespace berth::hal
