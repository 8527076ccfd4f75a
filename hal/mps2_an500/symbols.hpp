// What the linker script defines (linker/sections.ld): the borders of the memory map.
#pragma once

#include <cstdint>

extern "C" {
extern const std::uint32_t berth_flash_start[], berth_flash_end[];
extern const std::uint8_t berth_parameters_start[], berth_parameters_end[];
extern std::uint32_t berth_data_start[], berth_data_end[];
extern const std::uint32_t berth_data_load[];
extern std::uint32_t berth_bss_start[], berth_bss_end[];
extern std::uint32_t berth_stack_start[], berth_stack_end[];  // the application's
extern std::uint32_t berth_handler_stack_end[];
extern const std::uint8_t berth_external_start[];
using BerthConstructor = void (*)();
extern const BerthConstructor berth_init_array_start[], berth_init_array_end[];
}
