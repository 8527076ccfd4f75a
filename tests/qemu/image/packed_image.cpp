// An image that runs the packed operations' sweeps on the core and sends each one's digest and the
// number of words where intrinsic and portable twin differ.
#include <cstdint>

#include "hal/board.hpp"
#include "hal/clock.hpp"
#include "hal/serial.hpp"
#include "image/packed_sweep.hpp"

namespace berth {
namespace {

void send(std::uint32_t value) {
  std::uint8_t bytes[4];
  for (int i = 0; i < 4; ++i) bytes[i] = static_cast<std::uint8_t>(value >> (24 - 8 * i));
  hal::serial_write(bytes);
}

}  // namespace
}  // namespace berth

extern "C" [[noreturn]] void firmware_main() {
  using namespace berth;
  hal::board_open();
  hal::clock_start();
  hal::serial_open();
  for (const PackedSweep& sweep : kPackedSweeps) {
    std::uint32_t differences = 0;
    send(sweep.run(differences));
    send(differences);
  }
  hal::board_stop(0);
}
