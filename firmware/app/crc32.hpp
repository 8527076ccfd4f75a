// CRC-32 of the parameter block: IEEE 802.3, reflected polynomial 0xEDB88320, start and final xor
// 0xFFFFFFFF; the check value of "123456789" is 0xCBF43926.
#pragma once

#include <cstdint>

#include "core/span.hpp"

namespace berth {

/// A table of 16 words: two steps a byte, about 12 instructions.
std::uint32_t crc32(Span<const std::uint8_t> bytes);

}  // namespace berth
