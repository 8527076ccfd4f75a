// Serial line: CMSDK UART 0 (Arm DDI 0479), 115,200 baud at 25 MHz.
#include "hal/serial.hpp"

#include "mps2_an500/registers.hpp"

namespace berth::hal {

void serial_open() {
  reg::UartBaudDivider::write(reg::kProcessorClockHz / 115200);
  reg::UartControl::write(reg::kUartTransmitEnable);
}

namespace {

// The device takes a byte in 87 us; a line that is held up is the watchdog's business.
void wait_for_transmitter() {
  while ((reg::UartState::read() & reg::kUartTransmitFull) != 0) {
  }
}

}  // namespace

void serial_write(Span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    wait_for_transmitter();
    reg::UartData::write(byte);
  }
  wait_for_transmitter();
}

}  // namespace berth::hal
