#include "host_sim/render/sobol.hpp"

#include <array>

#include "host_sim/render/random.hpp"

namespace berth::host {
namespace {

// A primitive polynomial of degree s with inner coefficients a, and initial values m.
struct Polynomial {
  int s;
  uint32_t a;
  uint32_t m[7];
};

constexpr Polynomial kPolynomials[kSobolDimensions - 1] = {
    {1, 0, {1}},
    {2, 1, {1, 3}},
    {3, 1, {1, 3, 1}},
    {3, 2, {1, 1, 1}},
    {4, 1, {1, 1, 3, 3}},
    {4, 4, {1, 3, 5, 13}},
    {5, 2, {1, 1, 5, 5, 17}},
    {5, 4, {1, 1, 5, 5, 5}},
    {5, 7, {1, 1, 7, 11, 19}},
    {5, 11, {1, 1, 5, 1, 1}},
    {5, 13, {1, 1, 1, 3, 11}},
    {5, 14, {1, 3, 5, 5, 31}},
    {6, 1, {1, 3, 3, 9, 7, 49}},
    {6, 13, {1, 1, 1, 15, 21, 21}},
    {6, 16, {1, 3, 1, 13, 27, 49}},
    {6, 19, {1, 1, 1, 15, 7, 5}},
    {6, 22, {1, 3, 1, 15, 13, 25}},
    {6, 25, {1, 1, 5, 5, 19, 61}},
    {7, 1, {1, 3, 7, 11, 23, 15, 103}},
    {7, 4, {1, 3, 7, 13, 13, 15, 69}},
};

using Directions = std::array<std::array<uint32_t, 32>, kSobolDimensions>;

constexpr Directions make_directions() {
  Directions v{};
  for (int bit = 0; bit < 32; ++bit) v[0][bit] = 1u << (31 - bit);
  for (int d = 1; d < kSobolDimensions; ++d) {
    const Polynomial& p = kPolynomials[d - 1];
    for (int i = 0; i < p.s; ++i) v[d][i] = p.m[i] << (31 - i);
    for (int i = p.s; i < 32; ++i) {
      uint32_t value = v[d][i - p.s] ^ (v[d][i - p.s] >> p.s);
      for (int k = 1; k < p.s; ++k) {
        if ((p.a >> (p.s - 1 - k)) & 1u) value ^= v[d][i - k];
      }
      v[d][i] = value;
    }
  }
  return v;
}

constexpr Directions kDirections = make_directions();

}  // namespace

uint32_t sobol_bits(uint32_t index, int dimension) {
  uint32_t value = 0;
  for (int bit = 0; bit < 32; ++bit) {
    if ((index >> bit) & 1u) value ^= kDirections[dimension][bit];
  }
  return value;
}

double scrambled_sobol(uint64_t seed, uint32_t index, int dimension) {
  const uint32_t value = sobol_bits(index, dimension);
  const uint64_t key = mix_bits(seed, 0x50b01u + static_cast<uint64_t>(dimension));
  uint32_t scrambled = 0;
  for (int digit = 0; digit < 32; ++digit) {
    // The digits before this one choose whether it is flipped; a leading 1 tells their number.
    const uint64_t node = (1ull << digit) | (static_cast<uint64_t>(value) >> (32 - digit));
    const uint32_t flip = static_cast<uint32_t>(mix_bits(key, node) >> 63);
    scrambled |= (((value >> (31 - digit)) & 1u) ^ flip) << (31 - digit);
  }
  return (static_cast<double>(scrambled) + 0.5) * 0x1p-32;
}

}  // namespace berth::host
