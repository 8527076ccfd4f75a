#include "host_sim/budget/instruction_counts.hpp"

#include <algorithm>

#include "host_sim/decode/decode.hpp"
#include "host_sim/on_target/on_target.hpp"
#include "host_sim/report/summary.hpp"

namespace berth::host {
namespace {

FrameCount count_of(const std::string& name, const FrameTelemetry& telemetry) {
  const PlatformPacket& platform = *telemetry.platform;
  FrameCount count;
  count.name = name;
  for (std::size_t s = 0; s < count.stages.size(); ++s) {
    count.stages[s] = instructions_of(platform, platform.stage_ticks[s]);
  }
  count.frame = instructions_of(platform, platform.frame_ticks);
  count.work_units = telemetry.algorithm.work_units;
  count.identified = telemetry.pose.identified;
  return count;
}

}  // namespace

double InstructionCounts::quantile(double q,
                                   const std::function<double(const FrameCount&)>& value) const {
  std::vector<double> values;
  for (const FrameCount& frame : frames) values.push_back(value(frame));
  return host::quantile(values, q);
}

tl::expected<InstructionCounts, std::string> count_instructions(
    const std::vector<NamedFrame>& frames, const std::vector<std::uint8_t>& parameter_block,
    const std::string& image, const std::function<void()>& on_frame) {
  std::size_t sent = 0;
  const auto next = [&](TargetFrame& frame) {
    if (sent == frames.size()) return false;
    const cv::Mat& pixels = frames[sent].image;
    frame.index = static_cast<std::uint32_t>(sent++);
    frame.width = pixels.cols;
    frame.height = pixels.rows;
    frame.pixels = {pixels.data, pixels.total()};
    on_frame();
    return true;
  };
  TargetOptions options;
  options.image = image;
  const auto bytes = run_on_target(next, {parameter_block.data(), parameter_block.size()}, options);
  if (!bytes) return tl::unexpected(bytes.error());
  const auto telemetry = decode_telemetry({bytes->data(), bytes->size()});
  if (!telemetry) return tl::unexpected(telemetry.error());
  if (telemetry->frames.size() != frames.size()) {
    return tl::unexpected(std::string("the firmware did not answer every frame"));
  }
  InstructionCounts counts;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const FrameTelemetry& frame = telemetry->frames[i];
    if (!frame.platform) return tl::unexpected(std::string("a frame has no platform packet"));
    counts.frames.push_back(count_of(frames[i].name, frame));
    counts.stack_bytes = frame.platform->stack_bytes;
    counts.stack_peak_bytes = std::max(counts.stack_peak_bytes, frame.platform->stack_peak_bytes);
  }
  return counts;
}

}  // namespace berth::host
