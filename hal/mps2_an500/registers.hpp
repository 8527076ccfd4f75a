// The registers of the Cortex-M7 and of the MPS2 board (AN500) that the firmware touches, with the
// names of the Armv7-M Architecture Reference Manual and of Arm DAI 0400.
#pragma once

#include <cstdint>

namespace berth::hal::reg {

/// A memory-mapped 32-bit register.
template <std::uint32_t Address>
struct Register {
  static std::uint32_t read() { return *pointer(); }
  static void write(std::uint32_t value) { *pointer() = value; }

 private:
  static volatile std::uint32_t* pointer() {
    return reinterpret_cast<volatile std::uint32_t*>(Address);
  }
};

// SysTick: 24 bits down, from the processor clock.
using SystCsr = Register<0xe000e010>;
using SystRvr = Register<0xe000e014>;
using SystCvr = Register<0xe000e018>;
constexpr std::uint32_t kSystEnable = 1, kSystInterrupt = 2, kSystProcessorClock = 4;

// System control block.
using Icsr = Register<0xe000ed04>;
using Vtor = Register<0xe000ed08>;
using Aircr = Register<0xe000ed0c>;
using Ccr = Register<0xe000ed14>;
using Shcsr = Register<0xe000ed24>;
using Cfsr = Register<0xe000ed28>;
using Mmfar = Register<0xe000ed34>;
using Bfar = Register<0xe000ed38>;
constexpr std::uint32_t kAircrKey = 0x05fa0000, kAircrResetRequest = 4;
constexpr std::uint32_t kIcsrSysTickPending = 1u << 26;
constexpr std::uint32_t kCcrDivideByZeroTrap = 1u << 4, kCcrStackAlign = 1u << 9;
constexpr std::uint32_t kShcsrMemory = 1u << 16, kShcsrBus = 1u << 17, kShcsrUsage = 1u << 18;
constexpr std::uint32_t kCfsrMemoryAddressValid = 1u << 7, kCfsrBusAddressValid = 1u << 15;

// Memory protection unit, PMSAv7.
using MpuType = Register<0xe000ed90>;
using MpuCtrl = Register<0xe000ed94>;
using MpuRnr = Register<0xe000ed98>;
using MpuRbar = Register<0xe000ed9c>;
using MpuRasr = Register<0xe000eda0>;

// CMSDK UART 0.
using UartData = Register<0x40004000>;
using UartState = Register<0x40004004>;
using UartControl = Register<0x40004008>;
using UartBaudDivider = Register<0x40004010>;
constexpr std::uint32_t kUartTransmitFull = 1, kUartTransmitEnable = 1;

// CMSDK watchdog.
using WatchdogLoad = Register<0x40008000>;
using WatchdogControl = Register<0x40008008>;
using WatchdogClear = Register<0x4000800c>;
using WatchdogLock = Register<0x40008c00>;
constexpr std::uint32_t kWatchdogInterrupt = 1, kWatchdogReset = 2;
constexpr std::uint32_t kWatchdogKey = 0x1acce551;

constexpr std::uint32_t kProcessorClockHz = 25000000;

}  // namespace berth::hal::reg
