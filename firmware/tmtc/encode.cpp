#include "tmtc/packet_fields.hpp"
#include "tmtc/packets.hpp"

namespace berth {
namespace {

constexpr std::uint8_t flag(bool condition, int bit) {
  return static_cast<std::uint8_t>(condition ? 1u << bit : 0u);
}

}  // namespace

std::int32_t encode_pose(const PosePacket& packet, Span<std::uint8_t> source) {
  FieldWriter io(source);
  const auto flags =
      static_cast<std::uint8_t>(flag(packet.valid, 0) | flag(packet.identified, 1) |
                                flag(packet.has_pose, 2) | flag(packet.has_second, 3));
  const auto reason = static_cast<std::uint8_t>(packet.reason);
  visit_pose(io, packet, flags, reason);
  return io.finish();
}

std::int32_t encode_markers(const MarkersPacket& packet, Span<std::uint8_t> source) {
  FieldWriter io(source);
  io(packet.frame_index);
  io(static_cast<std::uint8_t>(packet.set.count));
  for (int i = 0; i < kMaxMarkers; ++i) {
    if (i >= packet.set.count) break;
    const Marker& marker = packet.set.markers[i];
    const auto kind = static_cast<std::uint8_t>(marker.kind);
    const auto flags = static_cast<std::uint8_t>(flag(marker.located, 0) | flag(marker.used, 1));
    visit_marker(io, marker, kind, flags);
  }
  return io.finish();
}

std::int32_t encode_algorithm(const AlgorithmPacket& packet, Span<std::uint8_t> source) {
  FieldWriter io(source);
  visit_algorithm(io, packet);
  return io.finish();
}

std::int32_t encode_frame_event(const FrameEventPacket& packet, Span<std::uint8_t> source) {
  FieldWriter io(source);
  io(kFrameEventId), io(packet.frame_index);
  io(static_cast<std::uint8_t>(packet.reason)), io(packet.work_units);
  return io.finish();
}

std::int32_t encode_platform(const PlatformPacket& packet, Span<std::uint8_t> source) {
  FieldWriter io(source);
  io(kPlatformStructureId);
  visit_platform(io, packet);
  return io.finish();
}

std::int32_t encode_boot(const BootPacket& packet, Span<std::uint8_t> source) {
  FieldWriter io(source);
  io(kBootEventId), io(packet.boot_count), io(packet.parameter_code);
  for (const char c : packet.parameter_text) io(static_cast<std::uint8_t>(c));
  return io.finish();
}

std::int32_t encode_fault(const FaultPacket& packet, Span<std::uint8_t> source) {
  FieldWriter io(source);
  io(kFaultEventId);
  const auto kind = static_cast<std::uint8_t>(packet.record.kind);
  visit_fault(io, packet.record, kind);
  return io.finish();
}

}  // namespace berth
