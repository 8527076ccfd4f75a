// Watchdog: CMSDK APB watchdog (Arm DDI 0479). First time-out: non-maskable interrupt, which
// leaves a fault record; second: reset.
#include "hal/watchdog.hpp"

#include "mps2_an500/registers.hpp"

namespace berth::hal {

void watchdog_start(std::uint32_t timeout_us) {
  constexpr std::uint32_t kTicksPerUs = reg::kProcessorClockHz / 1000000;
  reg::WatchdogLock::write(reg::kWatchdogKey);
  reg::WatchdogLoad::write(timeout_us * kTicksPerUs);
  reg::WatchdogControl::write(reg::kWatchdogInterrupt | reg::kWatchdogReset);
}

void watchdog_service() { reg::WatchdogClear::write(1); }

}  // namespace berth::hal
