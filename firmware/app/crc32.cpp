#include "app/crc32.hpp"

namespace berth {
namespace {

struct NibbleTable {
  std::uint32_t words[16] = {};
};

constexpr NibbleTable make_table() {
  NibbleTable table;
  for (std::uint32_t nibble = 0; nibble < 16; ++nibble) {
    std::uint32_t word = nibble;
    for (int bit = 0; bit < 4; ++bit) word = (word >> 1) ^ ((word & 1u) ? 0xEDB88320u : 0u);
    table.words[nibble] = word;
  }
  return table;
}

constexpr NibbleTable kTable = make_table();

}  // namespace

std::uint32_t crc32(Span<const std::uint8_t> bytes) {
  std::uint32_t crc = 0xFFFFFFFFu;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    crc = (crc >> 4) ^ kTable.words[crc & 0xFu];
    crc = (crc >> 4) ^ kTable.words[crc & 0xFu];
  }
  return ~crc;
}

}  // namespace berth
