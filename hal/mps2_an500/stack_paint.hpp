// The word that start-up fills the application's stack with.
#pragma once

#include <cstdint>

namespace berth::hal {

constexpr std::uint32_t kStackPaint = 0xa5c3965a;

}  // namespace berth::hal
