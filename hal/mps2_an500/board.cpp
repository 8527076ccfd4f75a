#include "hal/board.hpp"

#include <cstdint>

#include "mps2_an500/fault_memory.hpp"
#include "mps2_an500/protection.hpp"
#include "mps2_an500/registers.hpp"
#include "mps2_an500/semihosting.hpp"

namespace berth::hal {

void board_open() {
  fault_memory_open();
  reg::Shcsr::write(reg::kShcsrMemory | reg::kShcsrBus | reg::kShcsrUsage);
  reg::Ccr::write(reg::Ccr::read() | reg::kCcrDivideByZeroTrap | reg::kCcrStackAlign);
  protection_start();
}

void board_stop(int exit_code) {
  constexpr std::uint32_t kApplicationExit = 0x20026;
  const std::uint32_t block[2] = {kApplicationExit, static_cast<std::uint32_t>(exit_code)};
  semihosting::call(semihosting::Call::kExitExtended, block);
  for (;;) {
    // Without an emulator: the watchdog ends this.
  }
}

}  // namespace berth::hal
