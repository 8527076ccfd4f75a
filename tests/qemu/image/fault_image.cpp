// An image for the tests of the fault handling: the first frame's index says which hazard to
// provoke; the boot after it reports the record and ends the run. Same start-up, same protection
// and same linker script as the flight image.
#include <cstdint>

#include "app/platform_reporter.hpp"
#include "hal/board.hpp"
#include "hal/camera.hpp"
#include "hal/clock.hpp"
#include "hal/fault.hpp"
#include "hal/serial.hpp"
#include "hal/watchdog.hpp"
#include "hazards.hpp"
#include "tmtc/cobs.hpp"

namespace berth {
namespace {

[[gnu::section(".external")]] std::uint8_t frames[2][hal::kFrameBufferBytes];
std::uint8_t line_bytes[cobs_bound(kMaxPacketBytes) * 2];
LineWriter line(line_bytes);

void write_to(std::uint32_t address) { *reinterpret_cast<volatile std::uint32_t*>(address) = 1; }

std::uint32_t read_from(std::uint32_t address) {
  return *reinterpret_cast<volatile std::uint32_t*>(address);
}

volatile int depth_never_reached = 1 << 30;

// Deeper and deeper, a few bytes at a time.
[[gnu::noinline]] int recurse(volatile int depth) {
  volatile int here[4] = {depth};
  return here[0] == depth_never_reached ? 0 : recurse(here[0] + 1) + here[0];
}

// Over every guard zone in a single step.
[[gnu::noinline]] int leap() {
  volatile std::uint8_t large[256 * 1024];
  large[0] = 1;
  return large[0];
}

void run_from_data() {
  static std::uint16_t code[2] = {0x4770, 0x4770};  // bx lr
  const auto address = reinterpret_cast<std::uintptr_t>(code) | 1;
  reinterpret_cast<void (*)()>(address)();
}

void provoke(Hazard hazard) {
  switch (hazard) {
    case Hazard::kNone:
      return;
    case Hazard::kReadBehindData:
      read_from(kEndOfData);
      return;
    case Hazard::kReadBehindCode:
      read_from(kEndOfCode);
      return;
    case Hazard::kReadBehindFrames:
      read_from(kEndOfFrames);
      return;
    case Hazard::kWriteToFrame:
      return write_to(kFrames);
    case Hazard::kWriteToCode:
      return write_to(0);
    case Hazard::kUnusedPeripheral:
      return write_to(kUnusedPeripheral);
    case Hazard::kStackOverflow:
      recurse(0);
      return;
    case Hazard::kStackLeap:
      leap();
      return;
    case Hazard::kRunFromData:
      return run_from_data();
    case Hazard::kUndefinedInstruction:
      asm volatile("udf #1");
      return;
    case Hazard::kDivideByZero: {
      volatile int zero = 0, seven = 7;
      volatile int quotient = seven / zero;
      static_cast<void>(quotient);
      return;
    }
    case Hazard::kBrokenContract:
      static_cast<void>(Span<std::uint8_t>(line_bytes).subspan(sizeof line_bytes + 1));
      return;
    case Hazard::kHang:
      hal::watchdog_start(1000);
      for (;;) asm volatile("");
    case Hazard::kCount:
      return;
  }
}

void report_boot() {
  PlatformReporter reporter;
  reporter.report_boot(BlockStatus{}, line);
  hal::serial_write(line.bytes());
}

}  // namespace
}  // namespace berth

extern "C" [[noreturn]] void firmware_main() {
  using namespace berth;
  hal::board_open();
  hal::clock_start();
  hal::serial_open();
  report_boot();
  hal::CameraFrame frame;
  const bool first_boot = hal::fault_boot_count() == 1;
  if (first_boot && hal::camera_open({frames[0], frames[1]}) &&
      hal::camera_next_frame(frame) == hal::CameraEvent::kFrame) {
    provoke(static_cast<Hazard>(frame.index));
  }
  hal::board_stop(0);
}
