// One frame's outcome as its packets tell it.
//
// Every output of a replay (CSV, report, overlay text) is made from this and from nothing else, so
// that a run on the PC and one on the target, whose packets are equal, give equal bytes.
#pragma once

#include <string>

#include "host_sim/decode/decode.hpp"

namespace berth::host {

struct FrameRecord : FrameTelemetry {
  std::string file;

  bool valid() const { return pose.valid; }
  bool identified() const { return pose.identified; }
  bool has_pose() const { return pose.has_pose; }
  Reason reason() const { return pose.reason; }
};

/// "D0", "ring", "line".
std::string marker_name(const Marker& marker);

/// A fixed-point value as double; exact.
template <int F>
constexpr double to_double(Q<F> value) {
  return value.raw() / static_cast<double>(std::int64_t{1} << F);
}

constexpr double kDegreesPerRadian = 57.29577951308232;

}  // namespace berth::host
