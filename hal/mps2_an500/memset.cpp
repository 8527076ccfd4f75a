// The C library's memset, by blocks: newlib's spends seven instructions on 16 octets, and a frame
// clears some 300 KiB of sums.
#include <cstddef>
#include <cstdint>

/// Four instructions for 32 octets.
extern "C" [[gnu::optimize("no-tree-loop-distribute-patterns")]] void* memset(void* to, int value,
                                                                              std::size_t count) {
  auto* at = static_cast<std::uint8_t*>(to);
  const auto octet = static_cast<std::uint8_t>(value);
  for (; count > 0 && reinterpret_cast<std::uintptr_t>(at) % 4 != 0; --count) *at++ = octet;
  const std::uint32_t word = 0x01010101u * octet;
  std::size_t blocks = count / 32;
  if (blocks > 0) {
    asm volatile(
        "mov r4, %2\n mov r5, %2\n mov r6, %2\n mov r8, %2\n"
        "0: stmia %0!, {r4, r5, r6, r8}\n"
        "stmia %0!, {r4, r5, r6, r8}\n"
        "subs %1, %1, #1\n"
        "bne 0b"
        : "+r"(at), "+r"(blocks)
        : "r"(word)
        : "r4", "r5", "r6", "r8", "cc", "memory");
  }
  for (count %= 32; count >= 4; count -= 4, at += 4) {
    *reinterpret_cast<std::uint32_t*>(at) = word;
  }
  for (; count > 0; --count) *at++ = octet;
  return to;
}
