#include "app/application.hpp"

#include "app/platform_reporter.hpp"
#include "hal/clock.hpp"
#include "hal/memory.hpp"
#include "hal/serial.hpp"
#include "hal/watchdog.hpp"

namespace berth {
namespace {

// Of processing plus telemetry, in the clock's time: at 300 MHz 3 frames' worst case.
constexpr std::uint32_t kWatchdogTimeout_us = 2000000;

void send(LineWriter& line) {
  hal::serial_write(line.bytes());
  line.clear();
}

ApplicationEnd serve_camera(const ApplicationMemory& memory, PlatformReporter& platform) {
  StageClock clock;
  VisionTask task(memory.parameters, {memory.workspace, memory.result, memory.line},
                  clock.observer());
  hal::watchdog_start(kWatchdogTimeout_us);
  for (;;) {  // the board's life: ends with the camera's stream
    hal::CameraFrame frame;
    const hal::CameraEvent event = hal::camera_next_frame(frame);
    if (event == hal::CameraEvent::kEndOfStream) return ApplicationEnd::kEndOfStream;
    if (event == hal::CameraEvent::kDeviceError) return ApplicationEnd::kCameraError;
    clock.start_frame();
    hal::serial_write(task.on_frame(frame));
    memory.line.clear();
    platform.report_frame(frame.index, clock, memory.line);
    send(memory.line);
    hal::watchdog_service();
  }
}

}  // namespace

ApplicationEnd run_application(const ApplicationMemory& memory) {
  hal::clock_start();
  hal::serial_open();
  const BlockStatus status =
      decode_parameter_block(hal::memory_parameter_block(), memory.parameters);
  PlatformReporter platform;
  memory.line.clear();
  platform.report_boot(status, memory.line);
  send(memory.line);
  if (!status.is_ok()) return ApplicationEnd::kParametersRefused;
  if (!hal::camera_open(memory.frames)) return ApplicationEnd::kNoCamera;
  return serve_camera(memory, platform);
}

}  // namespace berth
