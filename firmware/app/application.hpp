// The application of the camera board: parameters in, then frames in and packets out until the
// camera has no more. The firmware image and the tests on the host run it alike.
#pragma once

#include <cstdint>

#include "app/parameter_block.hpp"
#include "app/vision_task.hpp"
#include "hal/camera.hpp"

namespace berth {

/// All memory the application works on; it belongs to the caller.
struct ApplicationMemory {
  Parameters& parameters;
  Workspace& workspace;
  FrameResult& result;
  LineWriter& line;  // over at least kFrameLineBytes
  hal::FrameBuffers frames;
};

/// Why the application came to an end; also the exit code of an emulated run.
enum class ApplicationEnd : std::uint8_t {
  kEndOfStream = 0,
  kParametersRefused = 1,  // the boot packet says why
  kNoCamera = 2,
  kCameraError = 3
};

/// Opens the devices, reports the boot, and serves the camera to the end.
ApplicationEnd run_application(const ApplicationMemory& memory);

}  // namespace berth
