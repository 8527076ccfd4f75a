// Memory that survives a reset: boot count and the last fault record.
#pragma once

namespace berth::hal {

/// Counts the boot; after power-on (contents without its check word) starts afresh.
void fault_memory_open();

}  // namespace berth::hal
