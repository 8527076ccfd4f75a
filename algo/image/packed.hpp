// Two 16-bit numbers, or four bytes, in one 32-bit word: what the Cortex-M7 adds in one
// instruction.
//
// A Pair's first number is its lower half. Each function exists as portable code and, where the
// compiler offers the ACLE SIMD32 intrinsics, as one or two instructions; the plain name is the
// faster of the two and both give the same bits on the stated domain (tests/image on the host,
// tests/qemu on the core). Lanes never carry into each other.
#pragma once

#include <cstdint>
#include <cstring>

#if defined(__ARM_FEATURE_SIMD32)
#include <arm_acle.h>
#define BERTH_PACKED_INTRINSICS 1
#else
#define BERTH_PACKED_INTRINSICS 0
#endif

namespace berth {

using Pair = std::uint32_t;

constexpr Pair both(std::uint32_t value) { return value << 16 | value; }

inline Pair load(const void* from) {
  Pair pair;
  std::memcpy(&pair, from, sizeof pair);
  return pair;
}

/// The same value, of which the compiler does not know how it follows from others: else it derives
/// addresses from one another where that costs more than it saves.
template <typename T>
T hidden(T value) {
#if defined(__arm__)
  asm("" : "+r"(value));
#endif
  return value;
}

/// The word at `from`, which moves on behind it: one instruction.
inline Pair load_next(const std::uint8_t*& from) {
#if BERTH_PACKED_INTRINSICS
  Pair pair;
  const std::uint8_t* at = from;
  asm("ldr %0, [%1], #4"
      : "=r"(pair), "+r"(at)
      : "m"(*reinterpret_cast<const std::uint8_t(*)[sizeof pair]>(from)));
  from = at;
  return pair;
#else
  from += sizeof(Pair);
  return load(from - sizeof(Pair));
#endif
}

/// Two words that lie side by side, which move in one instruction.
struct TwoPairs {
  Pair first, second;
};

inline TwoPairs load_two(const Pair (&from)[2]) {
  std::uint64_t word;
  std::memcpy(&word, __builtin_assume_aligned(from, 8), sizeof word);
  return {static_cast<Pair>(word), static_cast<Pair>(word >> 32)};
}

inline void store_two(Pair (&to)[2], Pair first, Pair second) {
  const std::uint64_t word = std::uint64_t{second} << 32 | first;
  std::memcpy(__builtin_assume_aligned(to, 8), &word, sizeof word);
}

namespace portable {

constexpr std::uint32_t kSigns = 0x80008000u;

/// floor((a + b) / 2) of each of four bytes.
constexpr std::uint32_t halve_byte_sums(std::uint32_t a, std::uint32_t b) {
  return (a & b) + ((a ^ b) >> 1 & 0x7f7f7f7fu);
}
/// Sum of the four bytes.
constexpr std::uint32_t sum_bytes(std::uint32_t a) {
  return ((a & 0x00ff00ffu) + (a >> 8 & 0x00ff00ffu)) * 0x00010001u >> 16;
}
/// floor((a + b) / 2) of each lane, unsigned.
constexpr Pair halve_sums(Pair a, Pair b) { return (a & b) + ((a ^ b) >> 1 & 0x7fff7fffu); }
/// The first number of `a` and the second of `b`.
constexpr Pair first_and_second(Pair a, Pair b) { return (a & 0xffffu) | (b & 0xffff0000u); }
/// a + b modulo 2^16.
constexpr Pair add_pairs(Pair a, Pair b) {
  return ((a & ~kSigns) + (b & ~kSigns)) ^ ((a ^ b) & kSigns);
}
/// a - b modulo 2^16.
constexpr Pair subtract_pairs(Pair a, Pair b) {
  return ((a | kSigns) - (b & ~kSigns)) ^ ((a ^ ~b) & kSigns);
}
/// |a| of signed lanes above -32768.
constexpr Pair absolute_pair(Pair a) {
  const Pair negative = a >> 15 & 0x00010001u;
  return (a ^ negative * 0xffffu) + negative;
}
/// max(a - b, 0) of unsigned lanes below 32768.
constexpr Pair excess(Pair a, Pair b) {
  const Pair difference = (a | kSigns) - b;
  const Pair keeps = (difference >> 15 & 0x00010001u) * 0x7fffu;
  return difference & keeps;
}

/// The nearest of -32..31.
constexpr int saturate_six_bits(int v) { return v > 31 ? 31 : (v < -32 ? -32 : v); }

/// sum + a_0 b_0 + a_1 b_1 of signed lanes; the result must fit 32 bits.
constexpr std::int32_t add_products(Pair a, Pair b, std::int32_t sum) {
  const auto lane = [](std::uint32_t bits) {
    return static_cast<std::int32_t>(bits ^ 0x8000u) - 0x8000;
  };
  return sum + lane(a & 0xffffu) * lane(b & 0xffffu) + lane(a >> 16) * lane(b >> 16);
}

/// The same in 64 bits.
constexpr std::int64_t add_products_wide(Pair a, Pair b, std::int64_t sum) {
  return sum + add_products(a & 0xffffu, b, 0) + add_products(a & 0xffff0000u, b, 0);
}

}  // namespace portable

#if BERTH_PACKED_INTRINSICS
inline std::uint32_t halve_byte_sums(std::uint32_t a, std::uint32_t b) { return __uhadd8(a, b); }
inline std::uint32_t sum_bytes(std::uint32_t a) { return __usad8(a, 0); }
inline Pair halve_sums(Pair a, Pair b) { return __uhadd16(a, b); }
inline Pair first_and_second(Pair a, Pair b) {
  Pair both_of;
  asm("pkhbt %0, %1, %2" : "=r"(both_of) : "r"(a), "r"(b));
  return both_of;
}
inline Pair add_pairs(Pair a, Pair b) { return __uadd16(a, b); }
inline Pair subtract_pairs(Pair a, Pair b) { return __usub16(a, b); }
inline Pair absolute_pair(Pair a) {
  const Pair negated = __ssub16(0, a);  // flags: lanes where 0 >= a
  return __sel(negated, a);
}
inline Pair excess(Pair a, Pair b) { return __uqsub16(a, b); }
inline int saturate_six_bits(int v) { return __ssat(v, 6); }
inline std::int32_t add_products(Pair a, Pair b, std::int32_t sum) {
  return __smlad(static_cast<int16x2_t>(a), static_cast<int16x2_t>(b), sum);
}
inline std::int64_t add_products_wide(Pair a, Pair b, std::int64_t sum) {
  return __smlald(static_cast<int16x2_t>(a), static_cast<int16x2_t>(b), sum);
}
#else
using portable::absolute_pair;
using portable::add_pairs;
using portable::add_products;
using portable::add_products_wide;
using portable::excess;
using portable::first_and_second;
using portable::halve_byte_sums;
using portable::halve_sums;
using portable::saturate_six_bits;
using portable::subtract_pairs;
using portable::sum_bytes;
#endif

}  // namespace berth
