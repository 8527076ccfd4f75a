// Clock: SysTick at the processor's 25 MHz, extended to 64 bits by its interrupt. Under QEMU's
// `-icount shift=0` one tick is 40 instructions.
#include "hal/clock.hpp"

#include "mps2_an500/handlers.hpp"
#include "mps2_an500/registers.hpp"

namespace berth::hal {
namespace {

constexpr std::uint32_t kPeriodTicks = 1u << 24;
volatile std::uint32_t periods = 0;

}  // namespace

void clock_start() {
  periods = 0;
  reg::SystRvr::write(kPeriodTicks - 1);
  reg::SystCvr::write(0);
  reg::SystCsr::write(reg::kSystEnable | reg::kSystInterrupt | reg::kSystProcessorClock);
}

std::uint64_t clock_ticks() {
  // The interrupt may strike between the reads: then the second turn sees it through.
  std::uint32_t before = 0, ticks = 0;
  for (int turn = 0; turn < 2; ++turn) {
    before = periods;
    ticks = kPeriodTicks - 1 - reg::SystCvr::read();
    if (before == periods) break;
  }
  return std::uint64_t{before} * kPeriodTicks + ticks;
}

std::uint32_t clock_rate_hz() { return reg::kProcessorClockHz; }

}  // namespace berth::hal

extern "C" void systick_handler() { berth::hal::periods = berth::hal::periods + 1; }
