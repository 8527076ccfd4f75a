// Packets one after the other as they go out on the serial line: each a COBS frame, closed by a
// zero. The counters that packets carry are kept per channel (APID).
#pragma once

#include <cstdint>

#include "core/span.hpp"
#include "tmtc/packets.hpp"
#include "tmtc/space_packet.hpp"

namespace berth {

/// The headers of one APID: sequence count per packet, message count per service and subtype.
class TelemetryChannel {
 public:
  explicit TelemetryChannel(std::uint16_t apid) : apid_(apid) {}

  /// Header of the next packet of this type. At most kMaxTypes types in a channel's life.
  PacketHeader next_header(PacketType type, CucTime time);

 private:
  static constexpr int kMaxTypes = 8;
  struct TypeCount {
    PacketType type{0, 0};
    std::uint16_t count = 0;
  };

  std::uint16_t count_message(PacketType type);

  std::uint16_t apid_;
  std::uint16_t sequence_count_ = 0;
  int types_ = 0;
  TypeCount counts_[kMaxTypes];
};

/// Collects framed packets in the caller's buffer.
class LineWriter {
 public:
  explicit LineWriter(Span<std::uint8_t> buffer) : buffer_(buffer) {}

  /// Where the next packet's source data goes.
  Span<std::uint8_t> source() {
    return Span<std::uint8_t>(packet_).subspan(kDataOffset, kMaxSourceBytes);
  }
  /// Appends the packet whose source data stands in source(). False when there are no source data
  /// or the buffer is full; then nothing is appended.
  bool append(const PacketHeader& header, std::int32_t source_bytes);
  /// All that was appended since the last clear().
  Span<const std::uint8_t> bytes() const { return buffer_.first(static_cast<std::size_t>(size_)); }
  void clear() { size_ = 0; }

 private:
  Span<std::uint8_t> buffer_;
  std::int32_t size_ = 0;
  std::uint8_t packet_[kMaxPacketBytes] = {};
};

}  // namespace berth
