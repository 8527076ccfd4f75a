// Semihosting calls (Arm's "Semihosting for AArch32 and AArch64"): the emulator reads host files
// on the firmware's behalf. The board has no camera, so the frames come this way.
#pragma once

#include <cstdint>

namespace berth::hal::semihosting {

enum class Call : std::uint32_t {
  kOpen = 0x01,
  kRead = 0x06,
  kGetCommandLine = 0x15,
  kExitExtended = 0x20
};

/// One call; `block` is the parameter block of the call. The host sees and changes memory.
inline std::int32_t call(Call operation, const void* block) {
  register std::uint32_t r0 asm("r0") = static_cast<std::uint32_t>(operation);
  register const void* r1 asm("r1") = block;
  asm volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
  return static_cast<std::int32_t>(r0);
}

}  // namespace berth::hal::semihosting
