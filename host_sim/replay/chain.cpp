#include "host_sim/replay/chain.hpp"

#include <array>
#include <stdexcept>

#include "app/parameter_block.hpp"
#include "app/vision_task.hpp"
#include "host_sim/report/trace.hpp"

namespace berth::host {
namespace {

Parameters decode(const std::vector<std::uint8_t>& block) {
  Parameters parameters;
  const BlockStatus status = decode_parameter_block({block.data(), block.size()}, parameters);
  std::array<char, kBlockText_bytes> text;
  if (!status.is_ok()) throw std::runtime_error(describe(status, text));
  return parameters;
}

}  // namespace

struct Chain::State {
  explicit State(const std::vector<std::uint8_t>& block) : parameters(decode(block)) {}

  Parameters parameters;
  Workspace workspace;
  FrameResult result;
  std::array<std::uint8_t, kFrameLineBytes> buffer{};
  LineWriter line{buffer};
  VisionTask task{parameters, {workspace, result, line}};
};

Chain::Chain(const std::vector<std::uint8_t>& parameter_block)
    : state_(std::make_unique<State>(parameter_block)) {}

Chain::~Chain() = default;

FrameRecord Chain::run(const cv::Mat& image, std::size_t index, std::uint32_t period_us) {
  hal::CameraFrame frame;
  frame.index = static_cast<std::uint32_t>(index);
  frame.mid_exposure_us = std::uint64_t{index} * period_us;
  const std::size_t bytes = image.total();
  if (!image.empty() && bytes <= static_cast<std::size_t>(hal::kFrameBufferBytes)) {
    frame.status = hal::FrameStatus::kComplete;
    frame.pixels = {image.data, bytes};
    frame.width = image.cols;
    frame.height = image.rows;
  }
  clear_trace(state_->workspace);
  auto telemetry = decode_telemetry(state_->task.on_frame(frame));
  if (!telemetry) throw std::runtime_error("the vision task's packets: " + telemetry.error());
  return FrameRecord{telemetry->frames.at(0), {}};
}

const Workspace& Chain::workspace() const { return state_->workspace; }

}  // namespace berth::host
