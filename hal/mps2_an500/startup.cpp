// Vector table and start-up: memory to its initial state, the application on a stack of its own.
//
// Handlers use the main stack, the application the process stack: when that overflows, the fault
// handler still has a stack to stand on.
#include <cstdint>

#include "mps2_an500/handlers.hpp"
#include "mps2_an500/stack_paint.hpp"
#include "mps2_an500/symbols.hpp"

namespace {

void copy_data() {
  const std::uint32_t* from = berth_data_load;
  for (std::uint32_t* to = berth_data_start; to < berth_data_end; ++to) *to = *from++;
}

void clear_bss() {
  for (std::uint32_t* word = berth_bss_start; word < berth_bss_end; ++word) *word = 0;
}

void paint_stack() {
  for (std::uint32_t* word = berth_stack_start; word < berth_stack_end; ++word) {
    *word = berth::hal::kStackPaint;
  }
}

union Vector {
  const void* stack;
  void (*handler)();
};

// The reset value of the main stack pointer, the system exceptions, then the board's 32 interrupts,
// none of which is used.
constexpr int kInterrupts = 32;
struct VectorTable {
  Vector initial_stack;
  Vector exceptions[15];
  Vector interrupts[kInterrupts];
};

constexpr VectorTable make_vectors() {
  VectorTable table{{berth_handler_stack_end}, {}, {}};
  for (auto& vector : table.exceptions) vector.handler = fault_handler;
  for (auto& vector : table.interrupts) vector.handler = fault_handler;
  table.exceptions[0].handler = reset_handler;
  table.exceptions[14].handler = systick_handler;
  return table;
}

[[gnu::section(".vectors"), gnu::used]] constexpr VectorTable kVectors = make_vectors();

}  // namespace

// On the main stack, before the application's exists.
extern "C" [[gnu::used]] void prepare_memory() {
  copy_data();
  clear_bss();
  paint_stack();
}

extern "C" [[gnu::used, noreturn]] void start_application() {
  for (const BerthConstructor* construct = berth_init_array_start; construct < berth_init_array_end;
       ++construct) {
    (*construct)();
  }
  firmware_main();
}

extern "C" [[gnu::naked]] void reset_handler() {
  asm volatile(
      "bl prepare_memory\n"
      "ldr r0, =berth_stack_end\n"
      "msr psp, r0\n"
      "movs r0, #2\n"  // thread mode: privileged, on the process stack
      "msr control, r0\n"
      "isb\n"
      "b start_application\n");
}
