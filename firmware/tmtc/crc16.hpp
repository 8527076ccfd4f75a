// CRC-16/CCITT-FALSE, the packet error control of ECSS-E-ST-70-41C (annex B): x^16 + x^12 + x^5 +
// 1, start 0xffff, no reflection, no final exclusive or. "123456789" gives 0x29b1.
#pragma once

#include <cstdint>

#include "core/span.hpp"

namespace berth {

/// Over all bytes; 0 over a packet that ends with its own CRC. Cost: about 12 instructions a byte.
std::uint16_t crc16(Span<const std::uint8_t> bytes);

}  // namespace berth
