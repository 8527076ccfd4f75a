#include "tmtc/packet_fields.hpp"
#include "tmtc/packets.hpp"

namespace berth {
namespace {

constexpr bool has_bit(std::uint8_t flags, int bit) { return (flags >> bit & 1) != 0; }

PacketError content_unless(bool good) { return good ? PacketError::kNone : PacketError::kContent; }

// Takes the event id in front of an event's fields.
bool is_event(FieldReader& io, std::uint16_t expected) {
  std::uint16_t id = 0;
  io(id);
  return id == expected;
}

bool take_marker(FieldReader& io, Marker& marker) {
  std::uint8_t kind = 0, flags = 0;
  visit_marker(io, marker, kind, flags);
  marker.kind = static_cast<MarkerKind>(kind);
  marker.located = has_bit(flags, 0);
  marker.used = has_bit(flags, 1);
  return kind <= static_cast<std::uint8_t>(MarkerKind::kLine) && flags < 4;
}

}  // namespace

PacketError decode_pose(Span<const std::uint8_t> source, PosePacket& packet) {
  FieldReader io(source);
  PosePacket p;
  std::uint8_t flags = 0, reason = 0;
  visit_pose(io, p, flags, reason);
  p.valid = has_bit(flags, 0);
  p.identified = has_bit(flags, 1);
  p.has_pose = has_bit(flags, 2);
  p.has_second = has_bit(flags, 3);
  p.reason = static_cast<Reason>(reason);
  if (!io.finish() || flags >= 16 || reason >= static_cast<std::uint8_t>(Reason::kCount)) {
    return PacketError::kContent;
  }
  packet = p;
  return PacketError::kNone;
}

PacketError decode_markers(Span<const std::uint8_t> source, MarkersPacket& packet) {
  FieldReader io(source);
  MarkersPacket p;
  std::uint8_t count = 0;
  io(p.frame_index), io(count);
  if (count > kMaxMarkers) return PacketError::kContent;
  p.set.count = count;
  for (int i = 0; i < kMaxMarkers; ++i) {
    if (i < count && !take_marker(io, p.set.markers[i])) return PacketError::kContent;
  }
  if (!io.finish()) return PacketError::kContent;
  packet = p;
  return PacketError::kNone;
}

PacketError decode_algorithm(Span<const std::uint8_t> source, AlgorithmPacket& packet) {
  FieldReader io(source);
  AlgorithmPacket p;
  visit_algorithm(io, p);
  if (io.finish()) packet = p;
  return content_unless(io.finish());
}

PacketError decode_frame_event(Span<const std::uint8_t> source, FrameEventPacket& packet) {
  FieldReader io(source);
  if (!is_event(io, kFrameEventId)) return PacketError::kWrongType;
  FrameEventPacket p;
  std::uint8_t reason = 0;
  io(p.frame_index), io(reason), io(p.work_units);
  p.reason = static_cast<Reason>(reason);
  const bool good = io.finish() && reason < static_cast<std::uint8_t>(Reason::kCount);
  if (good) packet = p;
  return content_unless(good);
}

PacketError decode_platform(Span<const std::uint8_t> source, PlatformPacket& packet) {
  FieldReader io(source);
  std::uint16_t structure = 0;
  io(structure);
  if (structure != kPlatformStructureId) return PacketError::kWrongType;
  PlatformPacket p;
  visit_platform(io, p);
  if (io.finish()) packet = p;
  return content_unless(io.finish());
}

PacketError decode_boot(Span<const std::uint8_t> source, BootPacket& packet) {
  FieldReader io(source);
  if (!is_event(io, kBootEventId)) return PacketError::kWrongType;
  BootPacket p;
  io(p.boot_count), io(p.parameter_code);
  for (char& c : p.parameter_text) {
    std::uint8_t octet = 0;
    io(octet);
    c = static_cast<char>(octet);
  }
  const bool good = io.finish() && p.parameter_text[BootPacket::kTextBytes - 1] == '\0';
  if (good) packet = p;
  return content_unless(good);
}

PacketError decode_fault(Span<const std::uint8_t> source, FaultPacket& packet) {
  FieldReader io(source);
  if (!is_event(io, kFaultEventId)) return PacketError::kWrongType;
  FaultPacket p;
  std::uint8_t kind = 0;
  visit_fault(io, p.record, kind);
  p.record.kind = static_cast<hal::FaultKind>(kind);
  const bool good =
      io.finish() && kind <= static_cast<std::uint8_t>(hal::FaultKind::kUnexpectedInterrupt);
  if (good) packet = p;
  return content_unless(good);
}

}  // namespace berth
