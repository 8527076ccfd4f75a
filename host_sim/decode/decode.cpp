#include "host_sim/decode/decode.hpp"

#include <algorithm>

#include "tmtc/cobs.hpp"

namespace berth::host {
namespace {

// Longer than any frame an encoder makes: a line that has lost its zeros must not eat memory.
constexpr std::size_t kMaxFrameBytes = cobs_bound(kMaxPacketBytes);

template <typename Contents>
tl::expected<Contents, PacketError> decode_as(const Packet& packet, PacketType type,
                                              PacketError (*decode)(Span<const std::uint8_t>,
                                                                    Contents&)) {
  if (!(packet.type() == type)) return tl::unexpected(PacketError::kWrongType);
  Contents contents;
  const PacketError error = decode(packet.source(), contents);
  if (error != PacketError::kNone) return tl::unexpected(error);
  return contents;
}

// Sorts packets into a Telemetry.
class Collector {
 public:
  bool add(const Packet& packet) {
    if (packet.header.apid == kApidVision) {
      auto& all = telemetry_.vision_octets;
      all.insert(all.end(), packet.octets.begin(), packet.octets.end());
    }
    const PacketType type = packet.type();
    if (type == kPoseType) return take_pose(packet);
    if (type == kMarkersType) return into_frame(decode_markers(packet), &FrameTelemetry::markers);
    if (type == kAlgorithmType) {
      return into_frame(decode_algorithm(packet), &FrameTelemetry::algorithm);
    }
    if (type == kPlatformType) {
      return into_frame(decode_platform(packet), &FrameTelemetry::platform);
    }
    if (type == kBootEventType) return append(decode_boot(packet), telemetry_.boots);
    if (type == kFaultEventType) return append(decode_fault(packet), telemetry_.faults);
    return type == kFrameEventType && decode_frame_event(packet).has_value();
  }
  Telemetry take() { return std::move(telemetry_); }

 private:
  bool take_pose(const Packet& packet) {
    auto pose = decode_pose(packet);
    if (pose) telemetry_.frames.emplace_back().pose = *pose;
    return pose.has_value();
  }
  // The other packets of a frame follow its pose packet.
  template <typename Contents, typename Member>
  bool into_frame(const tl::expected<Contents, PacketError>& contents,
                  Member FrameTelemetry::*member) {
    if (!contents || telemetry_.frames.empty()) return false;
    FrameTelemetry& frame = telemetry_.frames.back();
    if (frame.pose.frame_index != contents->frame_index) return false;
    frame.*member = *contents;
    return true;
  }
  template <typename Contents>
  static bool append(const tl::expected<Contents, PacketError>& contents,
                     std::vector<Contents>& list) {
    if (contents) list.push_back(*contents);
    return contents.has_value();
  }

  Telemetry telemetry_;
};

}  // namespace

Span<const std::uint8_t> Packet::source() const {
  return Span<const std::uint8_t>(octets).subspan(kDataOffset,
                                                  octets.size() - kDataOffset - kCrcBytes);
}

tl::expected<Packet, PacketError> decode_frame(Span<const std::uint8_t> frame) {
  Packet packet;
  packet.octets.resize(frame.size());
  const std::int32_t size = cobs_decode(frame, packet.octets);
  if (size < 0) return tl::unexpected(PacketError::kLineCode);
  packet.octets.resize(static_cast<std::size_t>(size));
  Span<const std::uint8_t> source;
  const PacketError error = decode_packet(packet.octets, packet.header, source);
  if (error != PacketError::kNone) return tl::unexpected(error);
  return packet;
}

tl::expected<PosePacket, PacketError> decode_pose(const Packet& packet) {
  return decode_as<PosePacket>(packet, kPoseType, berth::decode_pose);
}
tl::expected<MarkersPacket, PacketError> decode_markers(const Packet& packet) {
  return decode_as<MarkersPacket>(packet, kMarkersType, berth::decode_markers);
}
tl::expected<AlgorithmPacket, PacketError> decode_algorithm(const Packet& packet) {
  return decode_as<AlgorithmPacket>(packet, kAlgorithmType, berth::decode_algorithm);
}
tl::expected<FrameEventPacket, PacketError> decode_frame_event(const Packet& packet) {
  return decode_as<FrameEventPacket>(packet, kFrameEventType, berth::decode_frame_event);
}
tl::expected<PlatformPacket, PacketError> decode_platform(const Packet& packet) {
  return decode_as<PlatformPacket>(packet, kPlatformType, berth::decode_platform);
}
tl::expected<BootPacket, PacketError> decode_boot(const Packet& packet) {
  return decode_as<BootPacket>(packet, kBootEventType, berth::decode_boot);
}
tl::expected<FaultPacket, PacketError> decode_fault(const Packet& packet) {
  return decode_as<FaultPacket>(packet, kFaultEventType, berth::decode_fault);
}

void StreamDecoder::push(Span<const std::uint8_t> bytes, std::vector<Packet>& packets) {
  for (const std::uint8_t byte : bytes) {
    if (byte != 0) {
      if (frame_.size() < kMaxFrameBytes) frame_.push_back(byte);
      continue;
    }
    if (frame_.empty()) continue;  // zeros between frames are idle time on the line
    auto packet = decode_frame(frame_);
    frame_.clear();
    if (packet) {
      packets.push_back(std::move(*packet));
    } else {
      ++refused_;
      last_error_ = packet.error();
    }
  }
}

tl::expected<Telemetry, std::string> decode_telemetry(Span<const std::uint8_t> bytes) {
  StreamDecoder decoder;
  std::vector<Packet> packets;
  decoder.push(bytes, packets);
  if (decoder.refused() > 0) {
    return tl::unexpected("the telemetry has " + std::to_string(decoder.refused()) +
                          " damaged packets: " + packet_error_name(decoder.last_error()));
  }
  if (!decoder.is_at_frame_end()) return tl::unexpected(std::string("the telemetry is cut short"));
  Collector collector;
  for (const Packet& packet : packets) {
    if (!collector.add(packet)) {
      return tl::unexpected("unexpected telemetry packet (" +
                            std::to_string(packet.header.service) + ", " +
                            std::to_string(packet.header.subtype) + ")");
    }
  }
  return collector.take();
}

}  // namespace berth::host
