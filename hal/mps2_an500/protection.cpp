// Five of the MPU's eight regions; what no region covers faults, for privileged code too. The map
// is that of the reference parts (docs/memory.md), not of the board, which has more.
#include "mps2_an500/protection.hpp"

#include <cstdint>

#include "mps2_an500/registers.hpp"

namespace berth::hal {
namespace {

struct Region {
  std::uint32_t base;
  std::uint32_t size_log2;
  std::uint32_t disabled_eighths;  // bit per eighth of the region, lowest address first
  std::uint32_t attributes;
};

constexpr std::uint32_t kExecuteNever = 1u << 28;
constexpr std::uint32_t kReadOnly = 6u << 24, kReadWrite = 3u << 24;
constexpr std::uint32_t kNormal = 1u << 19 | 1u << 17 | 1u << 16;  // write-back, write-allocate
constexpr std::uint32_t kDevice = 1u << 16;

constexpr Region kRegions[] = {
    {0x00000000, 17, 0x00, kNormal | kReadOnly},                   // code, constants, parameters
    {0x20000000, 19, 0xc0, kNormal | kReadWrite | kExecuteNever},  // on-chip data: 384 of 512 KiB
    {0x60000000, 21, 0x00, kNormal | kReadOnly | kExecuteNever},   // frames: the camera writes them
    {0x40004000, 12, 0x00, kDevice | kReadWrite | kExecuteNever},  // UART 0
    {0x40008000, 12, 0x00, kDevice | kReadWrite | kExecuteNever},  // watchdog
};
constexpr std::uint32_t kRegionCount = sizeof kRegions / sizeof kRegions[0];
constexpr std::uint32_t kMpuRegions = 8;

void set_region(std::uint32_t number, std::uint32_t base, std::uint32_t attributes) {
  reg::MpuRnr::write(number);
  reg::MpuRbar::write(base);
  reg::MpuRasr::write(attributes);
}

}  // namespace

void protection_start() {
  reg::MpuCtrl::write(0);
  for (std::uint32_t i = 0; i < kMpuRegions; ++i) {
    if (i >= kRegionCount) {
      set_region(i, 0, 0);
      continue;
    }
    const Region& region = kRegions[i];
    set_region(i, region.base,
               region.attributes | region.disabled_eighths << 8 | (region.size_log2 - 1) << 1 | 1);
  }
  reg::MpuCtrl::write(1);  // no default map behind the regions
  asm volatile("dsb\n isb" ::: "memory");
}

}  // namespace berth::hal
