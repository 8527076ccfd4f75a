// Memory protection: the memory map as the processor enforces it.
#pragma once

namespace berth::hal {

/// Puts the MPU's regions up and switches it on. Cost: under 100 instructions.
void protection_start();

}  // namespace berth::hal
