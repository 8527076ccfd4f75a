#include "tmtc/line_writer.hpp"

#include "tmtc/cobs.hpp"

namespace berth {

PacketHeader TelemetryChannel::next_header(PacketType type, CucTime time) {
  PacketHeader header;
  header.apid = apid_;
  header.sequence_count = sequence_count_;
  header.service = type.service;
  header.subtype = type.subtype;
  header.message_count = count_message(type);
  header.time = time;
  sequence_count_ = static_cast<std::uint16_t>((sequence_count_ + 1) & 0x3fff);
  return header;
}

std::uint16_t TelemetryChannel::count_message(PacketType type) {
  for (int i = 0; i < kMaxTypes; ++i) {
    if (i < types_ && counts_[i].type == type) return counts_[i].count++;
  }
  if (types_ < kMaxTypes) counts_[types_++] = {type, 1};
  return 0;
}

bool LineWriter::append(const PacketHeader& header, std::int32_t source_bytes) {
  if (source_bytes <= 0) return false;
  const std::int32_t packet_bytes = encode_packet(header, source_bytes, packet_);
  if (packet_bytes == 0) return false;
  const std::int32_t line_bytes =
      cobs_encode(Span<const std::uint8_t>(packet_, static_cast<std::size_t>(packet_bytes)),
                  buffer_.subspan(static_cast<std::size_t>(size_)));
  size_ += line_bytes;
  return line_bytes > 0;
}

}  // namespace berth
