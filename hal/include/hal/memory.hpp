// What the platform knows about its memory: the parameter area and the stack.
#pragma once

#include <cstdint>

#include "core/span.hpp"

namespace berth::hal {

/// The parameter area of the non-volatile memory, read-only: a little-endian 32-bit byte count and
/// as many bytes of parameter block. Empty when the count is zero or does not fit the area.
Span<const std::uint8_t> memory_parameter_block();

/// Bytes of the application's stack, and how many of them were ever touched (the start-up paints
/// it; cost of the peak: one read per untouched word).
std::uint32_t memory_stack_bytes();
std::uint32_t memory_stack_peak_bytes();

}  // namespace berth::hal
