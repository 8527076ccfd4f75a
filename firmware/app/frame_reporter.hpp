// One frame's result as packets on the line. The only state is the counters of the packets, so
// that frames may be processed anywhere in any order and reported one after the other.
#pragma once

#include <cstdint>

#include "hal/camera.hpp"
#include "pipeline/result.hpp"
#include "tmtc/cobs.hpp"
#include "tmtc/line_writer.hpp"
#include "tmtc/packets.hpp"

namespace berth {

/// Bytes on the line for one frame at most: pose, markers, algorithm, event.
constexpr std::int32_t kFrameLineBytes = 4 * cobs_bound(kMaxPacketBytes);

class FrameReporter {
 public:
  /// Appends the frame's packets: pose, markers, algorithm, and an event for a frame without a
  /// valid pose. Their time is the frame's mid-exposure. Cost: about 25,000 instructions.
  void report(const hal::CameraFrame& frame, const FrameResult& result, LineWriter& line);

 private:
  TelemetryChannel channel_{kApidVision};
};

/// The packets of a result, as report() sends them. What the result does not have is zero.
PosePacket make_pose_packet(std::uint32_t frame_index, const FrameResult& result);
AlgorithmPacket make_algorithm_packet(std::uint32_t frame_index, const FrameResult& result);

}  // namespace berth
