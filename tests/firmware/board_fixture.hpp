// The application on the host's board: the same code that the firmware image runs.
#pragma once

#include <memory>
#include <vector>

#include "app/application.hpp"
#include "host/board.hpp"
#include "host_sim/decode/decode.hpp"

namespace berth::test {

/// Parameters of a 64 x 48 camera and a plain target: enough for everything around the chain.
inline Parameters small_parameters() {
  Parameters p;
  p.camera.width = 64;
  p.camera.height = 48;
  p.camera.fx = p.camera.fy = q<16>(80.0);
  p.camera.cx = q<16>(31.5);
  p.camera.cy = q<16>(23.5);
  p.target.plate_width_mm = p.target.plate_height_mm = q<18>(120.0);
  p.target.ring_outer_mm = q<18>(30.0);
  p.target.ring_inner_mm = q<18>(24.0);
  p.target.line_y_mm = q<18>(45.0);
  p.target.line_length_mm = q<18>(56.0);
  p.target.line_width_mm = q<18>(6.0);
  p.target.dot_count = 4;
  for (int i = 0; i < 4; ++i) {
    Dot& dot = p.target.dots[i];
    dot.center_mm = {Mm(i % 2 == 0 ? -45 : 45), Mm(i < 2 ? -45 : 45), Mm(0)};
    dot.radius_mm = Mm(6);
  }
  return p;
}

class OnHostBoard {
 public:
  OnHostBoard() {
    hal::host::board() = {};
    set_parameters(small_parameters());
  }

  void set_parameters(const Parameters& parameters) {
    std::vector<std::uint8_t> block(kMaxParameterBlock_bytes);
    block.resize(encode_parameter_block(parameters, block));
    hal::host::board().parameter_block = block;
  }
  void add_frame(std::uint32_t index, int width, int height, std::vector<std::uint8_t> pixels) {
    hal::host::board().frames.push_back(
        {index, index * std::uint64_t{125000}, width, height, std::move(pixels)});
  }
  void add_grey_frame(std::uint32_t index, int width, int height) {
    add_frame(index, width, height,
              std::vector<std::uint8_t>(static_cast<std::size_t>(width * height), 90));
  }
  ApplicationEnd run() {
    LineWriter line(line_bytes_);
    return run_application({parameters_, *workspace_, *result_, line, {first_, second_}});
  }
  static host::Telemetry telemetry() {
    auto telemetry = host::decode_telemetry(hal::host::board().line);
    return telemetry ? *telemetry : host::Telemetry{};
  }

 private:
  Parameters parameters_;
  std::unique_ptr<Workspace> workspace_ = std::make_unique<Workspace>();
  std::unique_ptr<FrameResult> result_ = std::make_unique<FrameResult>();
  std::vector<std::uint8_t> line_bytes_ = std::vector<std::uint8_t>(kFrameLineBytes);
  std::vector<std::uint8_t> first_ = std::vector<std::uint8_t>(hal::kFrameBufferBytes);
  std::vector<std::uint8_t> second_ = std::vector<std::uint8_t>(hal::kFrameBufferBytes);
};

}  // namespace berth::test
