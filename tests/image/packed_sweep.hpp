// Each packed operation over many words: the compiler's best against the portable twin; and what
// the board has in place of the C library's.
//
// Uses algo code only: the same sweeps run on the host and, in an image of their own, on the core.
#pragma once

#include <cstdint>

namespace berth {

struct PackedSweep {
  const char* name;
  /// Digest of the operation over its sweep, and the number of words where its twin differs.
  std::uint32_t (*run)(std::uint32_t& differences);
};

constexpr int kPackedSweepCount = 13;
extern const PackedSweep kPackedSweeps[kPackedSweepCount];

/// What the image sends per sweep, big-endian: digest and differences.
constexpr int kPackedRecordBytes = 8;

}  // namespace berth
