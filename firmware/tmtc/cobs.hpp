// Consistent overhead byte stuffing (Cheshire, Baker 1999): frames without a zero byte, so that a
// zero separates them on the line and a receiver can always find the next one.
#pragma once

#include <cstdint>

#include "core/span.hpp"

namespace berth {

/// Bytes on the line for a payload of `size` bytes, the closing zero included, at most.
constexpr std::int32_t cobs_bound(std::int32_t size) { return size + size / 254 + 2; }

/// Encodes `payload` into `line` and closes it with a zero. Returns the bytes written, or 0 when
/// `line` is shorter than cobs_bound() asks for.
std::int32_t cobs_encode(Span<const std::uint8_t> payload, Span<std::uint8_t> line);

/// Decodes one frame, without its closing zero, into `payload`. Returns the bytes written, or -1
/// for a frame that no encoder makes (a zero inside, a block cut short) or that does not fit.
std::int32_t cobs_decode(Span<const std::uint8_t> frame, Span<std::uint8_t> payload);

}  // namespace berth
