// Facts of the platform as packets with an APID of their own: boots, faults, instruction counts
// per stage, stack peak. Nothing here depends on a frame's contents, nor a frame's result on it.
#pragma once

#include <cstdint>

#include "app/parameter_block.hpp"
#include "pipeline/pipeline.hpp"
#include "tmtc/line_writer.hpp"

namespace berth {

/// Ticks of the hal clock that each stage of a frame took. Cost per stage: about 30 instructions.
class StageClock {
 public:
  void start_frame();
  /// For process_frame(); refers to this object.
  StageObserver observer();
  /// Ticks from start_frame() to the end of each stage; the frame's own part ends with its last.
  void copy_to(PlatformPacket& packet) const;

 private:
  static void on_stage_end(void* context, Stage stage);

  std::uint64_t start_ticks_ = 0, last_ticks_ = 0;
  std::uint32_t stage_ticks_[kStageCount] = {};
};

class PlatformReporter {
 public:
  /// Appends the boot packet and, when the last boot ended in a fault, that fault's record.
  void report_boot(const BlockStatus& parameters, LineWriter& line);
  /// Appends the platform packet of a frame that has just been processed.
  void report_frame(std::uint32_t frame_index, const StageClock& clock, LineWriter& line);

 private:
  CucTime uptime() const;

  TelemetryChannel channel_{kApidPlatform};
};

}  // namespace berth
