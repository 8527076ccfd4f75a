// Fault handlers: they leave a record in .noinit and reset the board; the next boot reports it.
#include "hal/fault.hpp"

#include "mps2_an500/fault_memory.hpp"
#include "mps2_an500/handlers.hpp"
#include "mps2_an500/registers.hpp"

namespace berth::hal {
namespace {

constexpr std::uint32_t kMagic = 0x42464c54;  // "BFLT"

struct FaultMemory {
  std::uint32_t magic;
  std::uint32_t boot_count, boot_count_inverse;
  std::uint32_t has_record;  // kMagic: `record` is one
  FaultRecord record;
};
// Raw bytes: an object would be initialised.
[[gnu::section(".noinit")]] alignas(FaultMemory) std::uint8_t fault_memory[sizeof(FaultMemory)];

FaultMemory& memory() { return *reinterpret_cast<FaultMemory*>(fault_memory); }

[[noreturn]] void keep_and_reset(FaultRecord record) {
  record.boot_count = memory().boot_count;
  memory().record = record;
  memory().has_record = kMagic;
  asm volatile("dsb" ::: "memory");
  reg::Aircr::write(reg::kAircrKey | reg::kAircrResetRequest);
  for (;;) {
    // The reset is on its way.
  }
}

// What the processor stacks on exception entry.
struct StackedFrame {
  std::uint32_t r0, r1, r2, r3, r12, lr, pc, xpsr;
};

constexpr std::uint32_t kStackingErrors = 1u << 4 | 1u << 12;  // MSTKERR, STKERR

FaultKind kind_of(std::uint32_t exception) {
  switch (exception) {
    case 2:
      return FaultKind::kWatchdog;
    case 3:
      return FaultKind::kHardFault;
    case 4:
      return FaultKind::kMemoryProtection;
    case 5:
      return FaultKind::kBus;
    case 6:
      return FaultKind::kUsage;
    default:
      return FaultKind::kUnexpectedInterrupt;
  }
}

}  // namespace

void fault_memory_open() {
  FaultMemory& m = memory();
  if (m.magic != kMagic || m.boot_count_inverse != ~m.boot_count) {
    m.boot_count = 0;
    m.has_record = 0;
    m.magic = kMagic;
  }
  ++m.boot_count;
  m.boot_count_inverse = ~m.boot_count;
}

FaultRecord fault_take_record() {
  if (memory().has_record != kMagic) return {};
  memory().has_record = 0;
  return memory().record;
}

std::uint32_t fault_boot_count() { return memory().boot_count; }

void fault_stop(FaultKind kind) {
  FaultRecord record;
  record.kind = kind;
  record.program_counter =
      static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(__builtin_return_address(0)));
  keep_and_reset(record);
}

}  // namespace berth::hal

// `stacked` is where the faulting code's registers are, if stacking them worked.
extern "C" [[gnu::used, noreturn]] void record_fault(const berth::hal::StackedFrame* stacked,
                                                     std::uint32_t exception) {
  namespace hal = berth::hal;
  hal::FaultRecord record;
  record.kind = hal::kind_of(exception);
  record.fault_status = hal::reg::Cfsr::read();
  record.stack_pointer = static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(stacked));
  if ((record.fault_status & hal::reg::kCfsrMemoryAddressValid) != 0) {
    record.fault_address = hal::reg::Mmfar::read();
  } else if ((record.fault_status & hal::reg::kCfsrBusAddressValid) != 0) {
    record.fault_address = hal::reg::Bfar::read();
  }
  if ((record.fault_status & hal::kStackingErrors) == 0) {
    record.program_counter = stacked->pc;
    record.link_register = stacked->lr;
  }
  hal::keep_and_reset(record);
}

extern "C" [[gnu::naked]] void fault_handler() {
  asm volatile(
      "tst lr, #4\n"  // which stack the faulting code was on
      "ite eq\n"
      "mrseq r0, msp\n"
      "mrsne r0, psp\n"
      "mrs r1, ipsr\n"
      "b record_fault\n");
}
