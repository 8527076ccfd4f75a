// Helpers of the parameter tests: blocks of CT-1 and HEC-1, and blocks that are wrong on purpose.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/crc32.hpp"
#include "app/parameter_block.hpp"
#include "host_sim/io/camera_file.hpp"
#include "host_sim/io/target_file.hpp"
#include "host_sim/parameters/build_block.hpp"

namespace berth::test {

inline Parameters default_parameters() {
  return host::make_parameters(host::default_camera(), host::default_target()).value();
}

inline std::vector<std::uint8_t> encoded(const Parameters& parameters) {
  std::vector<std::uint8_t> block(kMaxParameterBlock_bytes);
  block.resize(encode_parameter_block(parameters, block));
  return block;
}

inline std::vector<std::uint8_t> default_block() { return encoded(default_parameters()); }

inline std::uint32_t read_word(const std::vector<std::uint8_t>& bytes, std::size_t at) {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < 4; ++i) word |= std::uint32_t{bytes[at + i]} << (8 * i);
  return word;
}

inline void write_word(std::vector<std::uint8_t>& bytes, std::size_t at, std::uint32_t word) {
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::uint8_t>(word >> (8 * i));
}

/// Makes length and CRC fit whatever was done to the bytes.
inline void seal(std::vector<std::uint8_t>& bytes) {
  write_word(bytes, 8, static_cast<std::uint32_t>(bytes.size()));
  const std::size_t end = bytes.size() - 4;
  write_word(bytes, end, crc32(Span<const std::uint8_t>(bytes).first(end)));
}

inline void rename_section(std::vector<std::uint8_t>& bytes, std::size_t at, const char* id) {
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::uint8_t>(id[i]);
  seal(bytes);
}

inline BlockStatus decoded_status(const std::vector<std::uint8_t>& bytes) {
  Parameters out;
  return decode_parameter_block(bytes, out);
}

inline BlockCode decoded_code(const std::vector<std::uint8_t>& bytes) {
  return decoded_status(bytes).code;
}

inline std::string decoded_text(const std::vector<std::uint8_t>& bytes) {
  char text[kBlockText_bytes];
  return describe(decoded_status(bytes), text);
}

}  // namespace berth::test
