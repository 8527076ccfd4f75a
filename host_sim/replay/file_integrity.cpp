#include "host_sim/replay/file_integrity.hpp"

#include <algorithm>
#include <array>
#include <cstring>

namespace berth::host {
namespace {

using Bytes = std::vector<std::uint8_t>;

bool starts_with(const Bytes& bytes, const char* magic, std::size_t size) {
  return bytes.size() >= size && std::memcmp(bytes.data(), magic, size) == 0;
}

std::uint32_t big_endian_32(const std::uint8_t* p) {
  return (std::uint32_t{p[0]} << 24) | (std::uint32_t{p[1]} << 16) | (std::uint32_t{p[2]} << 8) |
         p[3];
}

std::array<std::uint32_t, 256> make_crc_table() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t c = i;
    for (int bit = 0; bit < 8; ++bit) c = (c & 1) != 0 ? 0xedb88320u ^ (c >> 1) : c >> 1;
    table[i] = c;
  }
  return table;
}

/// CRC-32 of a chunk's type and data (PNG specification, annex D).
std::uint32_t crc_of(const std::uint8_t* from, std::size_t size) {
  static const std::array<std::uint32_t, 256> kTable = make_crc_table();
  std::uint32_t c = 0xffffffffu;
  for (std::size_t i = 0; i < size; ++i) c = kTable[(c ^ from[i]) & 0xff] ^ (c >> 8);
  return ~c;
}

Integrity check_png(const Bytes& bytes) {
  std::size_t at = 8;
  while (at + 12 <= bytes.size()) {
    const std::size_t length = big_endian_32(&bytes[at]);
    if (at + 12 + length > bytes.size()) return Integrity::kTruncated;
    const std::uint8_t* const type = &bytes[at + 4];
    if (crc_of(type, 4 + length) != big_endian_32(type + 4 + length)) return Integrity::kDamaged;
    if (std::memcmp(type, "IEND", 4) == 0) return Integrity::kWhole;
    at += 12 + length;
  }
  return Integrity::kTruncated;
}

Integrity check_jpeg(const Bytes& bytes) {
  constexpr std::uint8_t kEnd[2] = {0xff, 0xd9};
  const auto tail = static_cast<std::ptrdiff_t>(std::min<std::size_t>(bytes.size(), 1024));
  const auto found = std::search(bytes.end() - tail, bytes.end(), kEnd, kEnd + 2);
  return found != bytes.end() ? Integrity::kWhole : Integrity::kTruncated;
}

}  // namespace

Integrity check_integrity(const Bytes& bytes) {
  if (starts_with(bytes, "\x89PNG\r\n\x1a\n", 8)) return check_png(bytes);
  if (starts_with(bytes, "\xff\xd8\xff", 3)) return check_jpeg(bytes);
  return Integrity::kWhole;
}

}  // namespace berth::host
