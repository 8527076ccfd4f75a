#include "app/platform_reporter.hpp"

#include "hal/clock.hpp"
#include "hal/fault.hpp"
#include "hal/memory.hpp"

namespace berth {

void StageClock::start_frame() {
  for (std::uint32_t& ticks : stage_ticks_) ticks = 0;
  start_ticks_ = last_ticks_ = hal::clock_ticks();
}

StageObserver StageClock::observer() { return {on_stage_end, this}; }

void StageClock::on_stage_end(void* context, Stage stage) {
  StageClock& clock = *static_cast<StageClock*>(context);
  const std::uint64_t now = hal::clock_ticks();
  // A stage may run in parts: its ticks add up.
  clock.stage_ticks_[static_cast<int>(stage)] +=
      static_cast<std::uint32_t>(now - clock.last_ticks_);
  clock.last_ticks_ = now;
}

void StageClock::copy_to(PlatformPacket& packet) const {
  packet.frame_ticks = static_cast<std::uint32_t>(last_ticks_ - start_ticks_);
  for (int s = 0; s < kStageCount; ++s) packet.stage_ticks[s] = stage_ticks_[s];
}

CucTime PlatformReporter::uptime() const {
  return cuc_from_us(hal::clock_ticks() * 1000000 / hal::clock_rate_hz());
}

void PlatformReporter::report_boot(const BlockStatus& parameters, LineWriter& line) {
  BootPacket boot;
  boot.boot_count = hal::fault_boot_count();
  boot.parameter_code = static_cast<std::uint8_t>(parameters.code);
  if (!parameters.is_ok()) describe(parameters, boot.parameter_text);
  line.append(channel_.next_header(kBootEventType, uptime()), encode_boot(boot, line.source()));
  const FaultPacket fault{hal::fault_take_record()};
  if (fault.record.kind == hal::FaultKind::kNone) return;
  line.append(channel_.next_header(kFaultEventType, uptime()), encode_fault(fault, line.source()));
}

void PlatformReporter::report_frame(std::uint32_t frame_index, const StageClock& clock,
                                    LineWriter& line) {
  PlatformPacket packet;
  packet.frame_index = frame_index;
  packet.uptime_ticks = hal::clock_ticks();
  packet.ticks_hz = hal::clock_rate_hz();
  clock.copy_to(packet);
  packet.stack_bytes = hal::memory_stack_bytes();
  packet.stack_peak_bytes = hal::memory_stack_peak_bytes();
  line.append(channel_.next_header(kPlatformType, uptime()),
              encode_platform(packet, line.source()));
}

}  // namespace berth
