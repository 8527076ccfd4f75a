// Serial line to the spacecraft bus: bytes out, in order, none lost.
#pragma once

#include <cstdint>

#include "core/span.hpp"

namespace berth::hal {

/// Prepares the line (8 bits, no parity, 1 stop bit).
void serial_open();

/// Sends all bytes; returns when the last one is with the device.
void serial_write(Span<const std::uint8_t> bytes);

}  // namespace berth::hal
