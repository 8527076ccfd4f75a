#include "tmtc/crc16.hpp"

namespace berth {
namespace {

// Remainders of the sixteen values of a nibble: 32 bytes of table instead of 512.
constexpr std::uint16_t kRemainder[16] = {0x0000, 0x1021, 0x2042, 0x3063, 0x4084, 0x50a5,
                                          0x60c6, 0x70e7, 0x8108, 0x9129, 0xa14a, 0xb16b,
                                          0xc18c, 0xd1ad, 0xe1ce, 0xf1ef};

constexpr std::uint16_t add_nibble(std::uint16_t crc, unsigned nibble) {
  return static_cast<std::uint16_t>((crc << 4) ^ kRemainder[(crc >> 12) ^ nibble]);
}

}  // namespace

std::uint16_t crc16(Span<const std::uint8_t> bytes) {
  std::uint16_t crc = 0xffff;
  for (const std::uint8_t byte : bytes) {
    crc = add_nibble(crc, byte >> 4);
    crc = add_nibble(crc, byte & 0xfu);
  }
  return crc;
}

}  // namespace berth
