// The end of a run: only emulators and tests ever get there.
#pragma once

namespace berth::hal {

/// Brings up memory protection and everything else that must stand before the first frame.
void board_open();

/// Ends the run: an emulator closes with this exit code, a board idles until its watchdog bites.
[[noreturn]] void board_stop(int exit_code);

}  // namespace berth::hal
