// The firmware image: the board, then the application, on the memory that storage.cpp lays out.
#include "hal/board.hpp"
#include "storage/storage.hpp"

extern "C" [[noreturn]] void firmware_main() {
  berth::hal::board_open();
  const berth::ApplicationEnd end = berth::run_application(berth::storage::application_memory());
  berth::hal::board_stop(static_cast<int>(end));
}
