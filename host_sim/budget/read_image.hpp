// What a linked image and its build folder say: memory, modules, stack.
#pragma once

#include <string>
#include <tl/expected.hpp>

#include "host_sim/budget/budget.hpp"

namespace berth::host {

/// Fills memory, modules, variables and stacks of `budget` from `image` (NAME.elf), the map beside
/// it and the compiler's .ci files below its folder. Error: one line that says what is missing.
tl::expected<void, std::string> read_image(const std::string& image, Budget& budget);

}  // namespace berth::host
