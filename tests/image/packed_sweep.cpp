#include "packed_sweep.hpp"

#include <cstring>

#include "core/digest.hpp"
#include "fixed/wide.hpp"
#include "image/packed.hpp"

namespace berth {
namespace {

constexpr int kWords = 20000;

// Lanes at and around the ends of their range, and pseudo-random ones.
constexpr std::uint16_t kCorners[] = {0,      1,      2,      127,    128,    255,    256,   257,
                                      0x7ffe, 0x7fff, 0x8000, 0x8001, 0xff00, 0xfffe, 0xffff};
constexpr int kCornerCount = static_cast<int>(sizeof kCorners / sizeof kCorners[0]);

class Words {
 public:
  std::uint32_t next() {
    const int i = count_++;
    if (i % 4 == 0) return corner(i / 4) | corner(i / (4 * kCornerCount) + i) << 16;
    state_ = state_ * 1664525u + 1013904223u;
    return state_ ^ state_ >> 15;
  }

 private:
  static std::uint32_t corner(int i) { return kCorners[i % kCornerCount]; }
  std::uint32_t state_ = 1;
  int count_ = 0;
};

template <typename F, typename G>
std::uint32_t sweep(F fast, G twin, std::uint32_t lanes, std::uint32_t& differences) {
  Words words;
  Digest digest;
  for (int i = 0; i < kWords; ++i) {
    const std::uint32_t a = words.next() & lanes, b = words.next() & lanes;
    const std::uint32_t result = fast(a, b);
    if (result != twin(a, b)) ++differences;
    digest.add(result);
  }
  return digest.value();
}

constexpr std::uint32_t kAll = 0xffffffffu, kPositive = 0x7fff7fffu;

#define BERTH_SWEEP(operation, lanes)                                                  \
  {                                                                                    \
#operation, [](std::uint32_t& differences) {                                         \
      return sweep([](Pair a, Pair b) { return operation(a, b); },                       \
                   [](Pair a, Pair b) { return portable::operation(a, b); }, lanes,      \
                   differences);                                                         \
    } \
  }
#define BERTH_SWEEP_OF_ONE(operation, lanes)                                           \
  {                                                                                    \
#operation, [](std::uint32_t& differences) {                                         \
      return sweep([](Pair a, Pair) { return operation(a); },                            \
                   [](Pair a, Pair) { return portable::operation(a); }, lanes,           \
                   differences);                                                         \
    } \
  }

}  // namespace

// The second operand without its signs: the sum of two products of -32768 does not fit.
static std::uint32_t sum_products(Pair a, Pair b) {
  return static_cast<std::uint32_t>(add_products(a, b & kPositive, -5));
}
static std::uint32_t sum_products_wide(Pair a, Pair b) {
  const std::int64_t sum = add_products_wide(a, b, -(std::int64_t{1} << 40) + 5);
  return static_cast<std::uint32_t>(sum) ^ static_cast<std::uint32_t>(sum >> 32);
}
static std::uint32_t saturate(Pair a) {
  return static_cast<std::uint32_t>(saturate_six_bits(static_cast<std::int32_t>(a) >> 24));
}
static std::uint32_t high_product(Pair a, Pair b) {
  return static_cast<std::uint32_t>(
      multiply_high(static_cast<std::int32_t>(a), static_cast<std::int32_t>(b)));
}
namespace portable {
static std::uint32_t high_product(Pair a, Pair b) {
  return static_cast<std::uint32_t>(
      multiply_high(static_cast<std::int32_t>(a), static_cast<std::int32_t>(b)));
}
static std::uint32_t saturate(Pair a) {
  return static_cast<std::uint32_t>(saturate_six_bits(static_cast<std::int32_t>(a) >> 24));
}
static std::uint32_t sum_products_wide(Pair a, Pair b) {
  const std::int64_t sum = add_products_wide(a, b, -(std::int64_t{1} << 40) + 5);
  return static_cast<std::uint32_t>(sum) ^ static_cast<std::uint32_t>(sum >> 32);
}
static std::uint32_t sum_products(Pair a, Pair b) {
  return static_cast<std::uint32_t>(add_products(a, b & kPositive, -5));
}
}  // namespace portable

// The C library's, which the board has its own of: every place in a word, every length to 100.
static std::uint32_t sweep_memset(std::uint32_t& differences) {
  constexpr int kBytes = 120;
  alignas(4) std::uint8_t bytes[kBytes];
  Digest digest;
  for (int first = 4; first < 8; ++first) {
    for (int count = 0; count <= 100; ++count) {
      const auto value = static_cast<std::uint8_t>(count * 5 + first);
      for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(~value);
      std::memset(bytes + first, value, static_cast<std::size_t>(count));
      for (int i = 0; i < kBytes; ++i) {
        const bool is_set = i >= first && i < first + count;
        differences += bytes[i] != (is_set ? value : static_cast<std::uint8_t>(~value));
        digest.add(bytes[i]);
      }
    }
  }
  return digest.value();
}

// absolute_pair(-32768) is 32768 on both sides, outside the stated domain.
const PackedSweep kPackedSweeps[kPackedSweepCount] = {BERTH_SWEEP(halve_byte_sums, kAll),
                                                      BERTH_SWEEP(halve_sums, kAll),
                                                      BERTH_SWEEP(add_pairs, kAll),
                                                      BERTH_SWEEP(subtract_pairs, kAll),
                                                      BERTH_SWEEP(excess, kPositive),
                                                      BERTH_SWEEP_OF_ONE(absolute_pair, kAll),
                                                      BERTH_SWEEP_OF_ONE(sum_bytes, kAll),
                                                      BERTH_SWEEP(sum_products, kAll),
                                                      BERTH_SWEEP(first_and_second, kAll),
                                                      BERTH_SWEEP(sum_products_wide, kAll),
                                                      BERTH_SWEEP_OF_ONE(saturate, kAll),
                                                      BERTH_SWEEP(high_product, kAll),
                                                      {"memset", sweep_memset}};

}  // namespace berth
