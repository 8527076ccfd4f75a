// The parameter block: camera, target, mounting and thresholds as one versioned run of bytes, made
// on the host, the same for host and firmware. The layout stands in docs/parameters.md.
//
//   header   "BPAR", u16 version, u16 sections, u32 length of the whole block
//   section  4 characters of id, u32 length of the payload, payload   (CAMR, TRGT, MNTS, THRS)
//   trailer  CRC-32 (crc32.hpp) of everything before
//
// Little-endian, field by field; every value is the raw 32-bit number of its Q format.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/field_fault.hpp"
#include "core/span.hpp"
#include "pipeline/parameters.hpp"

namespace berth {

constexpr std::uint16_t kParameterBlockVersion = 2;
constexpr std::size_t kMaxParameterBlock_bytes = 512;

enum class BlockCode : std::uint8_t {
  kOk = 0,
  kTooShort,          // fewer bytes than a header and a trailer
  kMagic,             // does not begin with "BPAR"
  kLength,            // the length in the header is not the number of bytes given
  kCrc,               // damaged
  kVersion,           // undamaged, but of a version that this program does not know
  kUnknownSection,    // `section` names it
  kDuplicateSection,  // `section` names it
  kMissingSection,    // `section` names it
  kSectionLength,     // the payload of `section` is too long or too short
  kOutOfRange,        // `field` is out of its range or contradicts the fields before it
};

/// What is wrong with a block. `section` is NUL-terminated, unprintable characters become '?'.
struct BlockStatus {
  BlockCode code = BlockCode::kOk;
  char section[5] = {};
  FieldFault fault;

  bool is_ok() const { return code == BlockCode::kOk; }
};

constexpr std::size_t kBlockText_bytes = 96;

/// One line without a line end: `value out of range: target.dots[2].radius_mm`. `text` should hold
/// kBlockText_bytes; a shorter one gets a shorter line, NUL-terminated. Returns its first character
/// (an empty text for an empty span).
const char* describe(const BlockStatus& status, Span<char> text);

/// Whether the chain can work with these values: camera, target, rotations orthonormal within
/// rounding, translations and thresholds in range.
BlockStatus validate_parameters(const Parameters& parameters);

/// Reads and validates a block; `out` is untouched unless the status is ok. Any bytes are a legal
/// input. `bytes` is the whole block and nothing else. Sections may stand in any order.
BlockStatus decode_parameter_block(Span<const std::uint8_t> bytes, Parameters& out);

/// Writes the block (this version, sections in the order CAMR, TRGT, MNTS, THRS) and returns its
/// size; 0 where `out` is too small or the number of dots is not 0..8. Values are not validated.
std::size_t encode_parameter_block(const Parameters& parameters, Span<std::uint8_t> out);

}  // namespace berth
