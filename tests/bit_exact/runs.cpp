#include "runs.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "app/parameter_block.hpp"
#include "app/vision_task.hpp"
#include "host_sim/io/camera_file.hpp"
#include "host_sim/io/target_file.hpp"
#include "host_sim/on_target/on_target.hpp"
#include "host_sim/parameters/build_block.hpp"

namespace berth::host {
namespace {

constexpr std::uint64_t kPeriod_us = 125000;

}  // namespace

Bytes block_with_budgets(std::int32_t search_units, std::int32_t frame_units) {
  Parameters parameters = make_parameters(default_camera(), default_target()).value();
  parameters.thresholds.search_budget_units = search_units;
  parameters.thresholds.frame_budget_units = frame_units;
  Bytes block(kMaxParameterBlock_bytes);
  block.resize(encode_parameter_block(parameters, block));
  return block;
}

Bytes run_on_host(const std::vector<NamedFrame>& frames, const Bytes& block) {
  Parameters parameters;
  EXPECT_TRUE(decode_parameter_block(block, parameters).is_ok());
  const auto workspace = std::make_unique<Workspace>();
  const auto result = std::make_unique<FrameResult>();
  Bytes buffer(kFrameLineBytes), all;
  LineWriter line(buffer);
  VisionTask task(parameters, {*workspace, *result, line});
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const NamedFrame& named = frames[i];
    hal::CameraFrame frame;
    frame.index = static_cast<std::uint32_t>(i);
    frame.mid_exposure_us = i * kPeriod_us;
    frame.width = named.width;
    frame.height = named.height;
    const auto announced = static_cast<std::size_t>(named.width) * named.height;
    if (announced == named.pixels.size() && announced <= hal::kFrameBufferBytes) {
      frame.status = hal::FrameStatus::kComplete;
      frame.pixels = named.pixels;
    }
    const auto bytes = task.on_frame(frame);
    all.insert(all.end(), bytes.begin(), bytes.end());
  }
  return all;
}

Bytes run_in_qemu(const std::vector<NamedFrame>& frames, const Bytes& block) {
  TargetOptions options;
  options.image = BERTH_FIRMWARE_BUILD "/berthmark.elf";
  std::size_t next = 0;
  const auto source = [&](TargetFrame& frame) {
    if (next == frames.size()) return false;
    frame.index = static_cast<std::uint32_t>(next);
    frame.mid_exposure_us = next * kPeriod_us;
    frame.width = frames[next].width;
    frame.height = frames[next].height;
    frame.pixels = frames[next].pixels;
    ++next;
    return true;
  };
  const auto line = run_on_target(source, block, options);
  EXPECT_TRUE(line.has_value()) << line.error();
  return line ? *line : Bytes{};
}

}  // namespace berth::host
