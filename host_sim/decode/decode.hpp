// What comes over the serial line, taken apart: COBS frames, packets, and what they say per frame.
//
// The same bytes come from the firmware in QEMU and from the vision task on the PC; everything the
// host prints about a pose is printed from here.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "core/span.hpp"
#include "tmtc/packets.hpp"

namespace berth::host {

/// One packet that passed all checks.
struct Packet {
  PacketHeader header;
  std::vector<std::uint8_t> octets;  // all of it, headers and CRC included

  PacketType type() const { return {header.service, header.subtype}; }
  Span<const std::uint8_t> source() const;
};

/// Takes one COBS frame (without its closing zero) apart.
tl::expected<Packet, PacketError> decode_frame(Span<const std::uint8_t> frame);

/// Contents of a packet; PacketError::kWrongType when it is of another type.
tl::expected<PosePacket, PacketError> decode_pose(const Packet& packet);
tl::expected<MarkersPacket, PacketError> decode_markers(const Packet& packet);
tl::expected<AlgorithmPacket, PacketError> decode_algorithm(const Packet& packet);
tl::expected<FrameEventPacket, PacketError> decode_frame_event(const Packet& packet);
tl::expected<PlatformPacket, PacketError> decode_platform(const Packet& packet);
tl::expected<BootPacket, PacketError> decode_boot(const Packet& packet);
tl::expected<FaultPacket, PacketError> decode_fault(const Packet& packet);

/// A byte stream cut into packets as it comes in; bytes may arrive in any portions.
class StreamDecoder {
 public:
  /// Appends what the bytes complete. Damaged frames are counted and skipped.
  void push(Span<const std::uint8_t> bytes, std::vector<Packet>& packets);
  /// Frames that were no packets, and the last one's error.
  int refused() const { return refused_; }
  PacketError last_error() const { return last_error_; }
  /// Whether the stream ended between two frames.
  bool is_at_frame_end() const { return frame_.empty(); }

 private:
  std::vector<std::uint8_t> frame_;
  int refused_ = 0;
  PacketError last_error_ = PacketError::kNone;
};

/// What the packets of one frame say.
struct FrameTelemetry {
  PosePacket pose;
  MarkersPacket markers;
  AlgorithmPacket algorithm;
  std::optional<PlatformPacket> platform;  // from the target only
};

/// A whole run. `frames` are in the order of their pose packets.
struct Telemetry {
  std::vector<FrameTelemetry> frames;
  std::vector<BootPacket> boots;
  std::vector<FaultPacket> faults;
  std::vector<std::uint8_t> vision_octets;  // packets of APID kApidVision, end to end: to compare
};

/// Takes a whole run apart. Error: one line that says what is wrong with the stream.
tl::expected<Telemetry, std::string> decode_telemetry(Span<const std::uint8_t> bytes);

}  // namespace berth::host
