#include "tmtc/cobs.hpp"

#include <cstddef>

namespace berth {
namespace {

constexpr std::uint8_t kFullBlock = 0xff;  // 254 bytes without a zero, and none implied after them

}  // namespace

std::int32_t cobs_encode(Span<const std::uint8_t> payload, Span<std::uint8_t> line) {
  const auto size = static_cast<std::int32_t>(payload.size());
  if (static_cast<std::int32_t>(line.size()) < cobs_bound(size)) return 0;
  std::size_t code_at = 0, out = 1;
  std::uint8_t code = 1;
  const auto close_block = [&] {
    line[code_at] = code;
    code_at = out++;
    code = 1;
  };
  for (std::size_t i = 0; i < payload.size(); ++i) {
    if (payload[i] == 0) {
      close_block();
      continue;
    }
    line[out++] = payload[i];
    ++code;
    if (code == kFullBlock && i + 1 < payload.size()) close_block();
  }
  line[code_at] = code;
  line[out++] = 0;
  return static_cast<std::int32_t>(out);
}

std::int32_t cobs_decode(Span<const std::uint8_t> frame, Span<std::uint8_t> payload) {
  std::size_t in = 0, out = 0;
  while (in < frame.size()) {
    const std::uint8_t code = frame[in++];
    if (code == 0 || code - 1u > frame.size() - in || code - 1u > payload.size() - out) return -1;
    for (int k = 1; k < code; ++k) {
      const std::uint8_t byte = frame[in++];
      if (byte == 0) return -1;
      payload[out++] = byte;
    }
    const bool zero_implied = code != kFullBlock && in < frame.size();
    if (!zero_implied) continue;
    if (out == payload.size()) return -1;
    payload[out++] = 0;
  }
  return static_cast<std::int32_t>(out);
}

}  // namespace berth
