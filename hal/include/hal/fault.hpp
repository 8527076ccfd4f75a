// Fault records: what a fault handler leaves in memory that survives the reset that follows.
#pragma once

#include <cstdint>

namespace berth::hal {

enum class FaultKind : std::uint8_t {
  kNone = 0,
  kHardFault,
  kMemoryProtection,  // access outside the memory map, a write to a frame, stack overflow
  kBus,
  kUsage,
  kWatchdog,
  kTerminate,       // a span or library contract was broken
  kRangeViolation,  // a stated range did not hold (range-checking build)
  kUnexpectedInterrupt
};

struct FaultRecord {
  FaultKind kind = FaultKind::kNone;
  std::uint32_t program_counter = 0;  // 0 when the fault destroyed it
  std::uint32_t link_register = 0;
  std::uint32_t stack_pointer = 0;
  std::uint32_t fault_status = 0;   // CFSR
  std::uint32_t fault_address = 0;  // MMFAR or BFAR, 0 when not valid
  std::uint32_t boot_count = 0;     // of the boot in which it happened, from 1
};

/// The record that the boot before this one left, taken once: a second call gives kNone.
FaultRecord fault_take_record();

/// Boots since power-on, this one included.
std::uint32_t fault_boot_count();

/// Leaves a record with the caller's address and resets the board.
[[noreturn]] void fault_stop(FaultKind kind);

}  // namespace berth::hal
