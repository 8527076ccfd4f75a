// Sweeps over the whole domain of each arithmetic function, folded into one digest each.
//
// The digests are the code's own output, kept as constants: what is right is tested against double
// elsewhere; here a single number proves that a compiler, an option or the Arm target changed no
// bit. Uses algo code only, so the very same sweeps run on the emulated Cortex-M7.
#pragma once

#include <cstdint>

namespace berth_test {

struct Sweep {
  const char* name;
  std::uint32_t (*run)();
  std::uint32_t digest;  // what run() gives on every platform
};

constexpr int kSweepCount = 12;
extern const Sweep kSweeps[kSweepCount];

}  // namespace berth_test
