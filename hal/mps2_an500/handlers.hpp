// Entry points that the vector table names.
#pragma once

extern "C" {
[[noreturn]] void reset_handler();
void fault_handler();
void systick_handler();

/// The application, on its own stack; defined by the image.
[[noreturn]] void firmware_main();
}
