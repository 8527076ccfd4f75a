// Random numbers that depend on a key and a position only, the same on every machine.
#pragma once

#include <cstdint>

namespace berth::host {

/// A well-mixed 64-bit value of a key and a stream number (finaliser of SplitMix64).
inline uint64_t mix_bits(uint64_t key, uint64_t stream) {
  uint64_t z = key + (stream + 1) * 0x9E3779B97F4A7C15ull;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
  return z ^ (z >> 31);
}

/// SplitMix64 (Steele, Lea, Flood 2014): one addition and one mix per number.
class Random {
 public:
  explicit Random(uint64_t key) : state_(mix_bits(key, 0x7261)) {}
  Random(uint64_t key, uint64_t stream) : state_(mix_bits(mix_bits(key, 0x7261), stream)) {}

  uint64_t bits() {
    const uint64_t value = mix_bits(state_, 0);
    state_ += 0x9E3779B97F4A7C15ull;
    return value;
  }

  /// Uniform in [0, 1), 53 bits.
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }

  /// Uniform in [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// Whole number in [0, count).
  int below(int count) { return static_cast<int>(uniform() * count); }

  bool chance(double probability) { return uniform() < probability; }

  /// Standard normal deviate (ziggurat).
  double gaussian();

 private:
  uint64_t state_;
};

}  // namespace berth::host
