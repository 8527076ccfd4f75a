#include "hal/memory.hpp"

#include <cstddef>

#include "mps2_an500/stack_paint.hpp"
#include "mps2_an500/symbols.hpp"

namespace berth::hal {

Span<const std::uint8_t> memory_parameter_block() {
  const auto area = static_cast<std::size_t>(berth_parameters_end - berth_parameters_start);
  const std::uint8_t* start = berth_parameters_start;
  const std::uint32_t size = start[0] | static_cast<std::uint32_t>(start[1]) << 8 |
                             static_cast<std::uint32_t>(start[2]) << 16 |
                             static_cast<std::uint32_t>(start[3]) << 24;
  if (size > area - sizeof size) return {};
  return {start + sizeof size, size};
}

std::uint32_t memory_stack_bytes() {
  return static_cast<std::uint32_t>(berth_stack_end - berth_stack_start) * sizeof(std::uint32_t);
}

std::uint32_t memory_stack_peak_bytes() {
  const volatile std::uint32_t* word = berth_stack_start;
  while (word < berth_stack_end && *word == kStackPaint) ++word;
  return static_cast<std::uint32_t>(berth_stack_end - word) * sizeof(std::uint32_t);
}

}  // namespace berth::hal
