// Runs of frames through the chain: on the host, and on the emulated core.
#pragma once

#include "frame_set.hpp"

namespace berth::host {

using Bytes = std::vector<std::uint8_t>;

/// The block of HEC-1 and CT-1 with other budgets.
Bytes block_with_budgets(std::int32_t search_units, std::int32_t frame_units);

/// The serial line of all frames.
Bytes run_on_host(const std::vector<NamedFrame>& frames, const Bytes& block);
Bytes run_in_qemu(const std::vector<NamedFrame>& frames, const Bytes& block);

}  // namespace berth::host
