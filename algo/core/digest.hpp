// Digest of a stage's results: one 32-bit number that is equal on host and target, or something
// differs. FNV-1a over 32-bit words instead of bytes (four times cheaper, still order-sensitive).
#pragma once

#include <cstdint>

namespace berth {

class Digest {
 public:
  constexpr void add(std::uint32_t word) { state_ = (state_ ^ word) * kPrime; }
  constexpr void add_signed(std::int32_t word) { add(static_cast<std::uint32_t>(word)); }
  constexpr void add_wide(std::int64_t word) {
    add(static_cast<std::uint32_t>(word));
    add(static_cast<std::uint32_t>(static_cast<std::uint64_t>(word) >> 32));
  }
  constexpr std::uint32_t value() const { return state_; }

 private:
  static constexpr std::uint32_t kPrime = 16777619u;
  std::uint32_t state_ = 2166136261u;
};

}  // namespace berth
