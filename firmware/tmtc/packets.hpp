// The telemetry packets' source data: structures, and their octets on the wire
// (docs/interfaces.md has the octet tables).
//
// Numbers keep the Q formats of their structure's fields: lengths 2^-18 mm, quaternions and
// correlations 2^-30, angles 2^-28 rad, pixels 2^-16, marker variances 2^-24 px^2.
// encode_* returns the octets written to `source`, or 0 when it is too short; decode_* leaves
// `packet` untouched on an error. Cost: about 15 instructions per octet.
#pragma once

#include <cstdint>

#include "core/reason.hpp"
#include "core/span.hpp"
#include "hal/fault.hpp"
#include "pipeline/result.hpp"
#include "pose/pose.hpp"
#include "tmtc/space_packet.hpp"

namespace berth {

constexpr std::uint16_t kApidVision = 0x0b0;    // equal on host and target, bit for bit
constexpr std::uint16_t kApidPlatform = 0x0b1;  // facts of the platform that ran it

/// Service and subtype; events are told apart by their event id as well.
struct PacketType {
  std::uint8_t service, subtype;

  friend constexpr bool operator==(PacketType a, PacketType b) {
    return a.service == b.service && a.subtype == b.subtype;
  }
};
constexpr PacketType kPoseType{128, 1};
constexpr PacketType kMarkersType{128, 2};
constexpr PacketType kAlgorithmType{128, 3};
constexpr PacketType kPlatformType{3, 25};   // housekeeping parameter report
constexpr PacketType kBootEventType{5, 1};   // informative
constexpr PacketType kFrameEventType{5, 2};  // low severity
constexpr PacketType kFaultEventType{5, 4};  // high severity

constexpr std::uint16_t kFrameEventId = 1;
constexpr std::uint16_t kBootEventId = 2;
constexpr std::uint16_t kFaultEventId = 3;
constexpr std::uint16_t kPlatformStructureId = 1;

/// A rigid transform as the wire carries it.
struct WireTransform {
  Mm translation_mm[3];
  Quaternion rotation{};
};

/// (128, 1) One per frame. What the flags deny is zero.
struct PosePacket {
  std::uint32_t frame_index = 0;
  bool valid = false;
  bool identified = false;
  bool has_pose = false;
  bool has_second = false;
  Reason reason = Reason::kBadFrame;
  std::uint8_t markers_used = 0;
  WireTransform camera_from_target;
  PoseCovariance covariance;
  Px residual_px;
  Unit ambiguity;
  WireTransform effector_from_latch;
  PoseCovariance effector_covariance;
  WireTransform second;
  Px second_residual_px;
};

/// (128, 2) One per frame: the markers as measured.
struct MarkersPacket {
  std::uint32_t frame_index = 0;
  MarkerSet set;
};

/// (128, 3) One per frame: what happened in the stages.
struct AlgorithmPacket {
  std::uint32_t frame_index = 0;
  std::uint32_t digests[kStageCount] = {};
  std::uint32_t work_units = 0;
  FrameTally tally;
  Px ring_center_px[2];  // of the pose, or of the ring's outline; zero when not identified
  Px ring_radius_px;
  Angle roll;
};

/// (5, 2) event 1: a frame without a valid pose.
struct FrameEventPacket {
  std::uint32_t frame_index = 0;
  Reason reason = Reason::kBadFrame;
  std::uint32_t work_units = 0;
};

/// (3, 25) structure 1: facts of the platform for one frame.
struct PlatformPacket {
  std::uint32_t frame_index = 0;
  std::uint64_t uptime_ticks = 0;  // when the frame's processing ended
  std::uint32_t ticks_hz = 0;
  std::uint32_t frame_ticks = 0;                // all stages
  std::uint32_t stage_ticks[kStageCount] = {};  // zero for a stage that did not run
  std::uint32_t stack_bytes = 0;
  std::uint32_t stack_peak_bytes = 0;  // since boot
};

/// (5, 1) event 2: the application started, with or without parameters.
struct BootPacket {
  static constexpr int kTextBytes = 96;

  std::uint32_t boot_count = 0;
  std::uint8_t parameter_code = 0;       // BlockCode; 0: accepted
  char parameter_text[kTextBytes] = {};  // what is wrong with the parameter block, NUL-padded
};

/// (5, 4) event 3: the boot before this one ended in a fault.
struct FaultPacket {
  hal::FaultRecord record;
};

std::int32_t encode_pose(const PosePacket& packet, Span<std::uint8_t> source);
std::int32_t encode_markers(const MarkersPacket& packet, Span<std::uint8_t> source);
std::int32_t encode_algorithm(const AlgorithmPacket& packet, Span<std::uint8_t> source);
std::int32_t encode_frame_event(const FrameEventPacket& packet, Span<std::uint8_t> source);
std::int32_t encode_platform(const PlatformPacket& packet, Span<std::uint8_t> source);
std::int32_t encode_boot(const BootPacket& packet, Span<std::uint8_t> source);
std::int32_t encode_fault(const FaultPacket& packet, Span<std::uint8_t> source);

PacketError decode_pose(Span<const std::uint8_t> source, PosePacket& packet);
PacketError decode_markers(Span<const std::uint8_t> source, MarkersPacket& packet);
PacketError decode_algorithm(Span<const std::uint8_t> source, AlgorithmPacket& packet);
PacketError decode_frame_event(Span<const std::uint8_t> source, FrameEventPacket& packet);
PacketError decode_platform(Span<const std::uint8_t> source, PlatformPacket& packet);
PacketError decode_boot(Span<const std::uint8_t> source, BootPacket& packet);
PacketError decode_fault(Span<const std::uint8_t> source, FaultPacket& packet);

}  // namespace berth
