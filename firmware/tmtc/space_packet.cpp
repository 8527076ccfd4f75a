#include "tmtc/space_packet.hpp"

#include "tmtc/byte_order.hpp"
#include "tmtc/crc16.hpp"

namespace berth {
namespace {

constexpr std::uint16_t kApidMask = 0x07ff;
constexpr std::uint16_t kSequenceMask = 0x3fff;
constexpr std::uint16_t kTelemetryWithSecondaryHeader = 0x0800;  // version 0, type 0, flag 1
constexpr std::uint16_t kUnsegmented = 0xc000;
constexpr std::uint8_t kPusVersion = 0x20;  // PUS-C is 2; time reference status 0

void put_headers(const PacketHeader& header, std::int32_t total_bytes, ByteWriter& out) {
  out.u16(kTelemetryWithSecondaryHeader | (header.apid & kApidMask));
  out.u16(kUnsegmented | (header.sequence_count & kSequenceMask));
  out.u16(static_cast<std::uint32_t>(total_bytes - kPrimaryHeaderBytes - 1));
  out.u8(kPusVersion);
  out.u8(header.service);
  out.u8(header.subtype);
  out.u16(header.message_count);
  out.u16(header.destination);
  out.u32(header.time.seconds);
  out.u24(header.time.fraction);
}

}  // namespace

CucTime cuc_from_us(std::uint64_t time_us) {
  constexpr std::uint64_t kUsPerSecond = 1000000;
  return {static_cast<std::uint32_t>(time_us / kUsPerSecond),
          static_cast<std::uint32_t>(((time_us % kUsPerSecond) << 24) / kUsPerSecond)};
}

const char* packet_error_name(PacketError error) {
  constexpr const char* kNames[] = {"none", "line_code", "too_short",  "length_mismatch",
                                    "crc",  "header",    "wrong_type", "content"};
  return kNames[static_cast<int>(error)];
}

std::int32_t encode_packet(const PacketHeader& header, std::int32_t source_bytes,
                           Span<std::uint8_t> packet) {
  const std::int32_t total = kDataOffset + source_bytes + kCrcBytes;
  if (source_bytes < 0 || total > static_cast<std::int32_t>(packet.size())) return 0;
  ByteWriter head(packet.first(kDataOffset));
  put_headers(header, total, head);
  const auto crc_at = static_cast<std::size_t>(kDataOffset + source_bytes);
  ByteWriter tail(packet.subspan(crc_at, kCrcBytes));
  tail.u16(crc16(packet.first(crc_at)));
  return total;
}

PacketError decode_packet(Span<const std::uint8_t> packet, PacketHeader& header,
                          Span<const std::uint8_t>& source) {
  const auto size = static_cast<std::int32_t>(packet.size());
  if (size < kDataOffset + kCrcBytes) return PacketError::kTooShort;
  ByteReader in(packet);
  const std::uint16_t identification = in.u16();
  const std::uint16_t sequence = in.u16();
  if (in.u16() != size - kPrimaryHeaderBytes - 1) return PacketError::kLengthMismatch;
  if (crc16(packet) != 0) return PacketError::kCrc;
  if ((identification & ~kApidMask) != kTelemetryWithSecondaryHeader ||
      (sequence & ~kSequenceMask) != kUnsegmented || in.u8() != kPusVersion) {
    return PacketError::kHeader;
  }
  header.apid = identification & kApidMask;
  header.sequence_count = sequence & kSequenceMask;
  header.service = in.u8();
  header.subtype = in.u8();
  header.message_count = in.u16();
  header.destination = in.u16();
  header.time.seconds = in.u32();
  header.time.fraction = in.u24();
  source = packet.subspan(kDataOffset, static_cast<std::size_t>(size - kDataOffset - kCrcBytes));
  return PacketError::kNone;
}

}  // namespace berth
