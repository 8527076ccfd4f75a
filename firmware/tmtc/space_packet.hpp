// Space packets: CCSDS 133.0-B-2 primary header, PUS-C telemetry secondary header
// (ECSS-E-ST-70-41C, 7.4.3), source data, CRC-16.
//
//   octet  0     version 000, type 0 (telemetry), secondary header flag 1, APID bits 10..8
//          1     APID bits 7..0
//          2     sequence flags 11 (unsegmented), sequence count bits 13..8
//          3     sequence count bits 7..0
//          4, 5  octets that follow this field, minus one
//          6     PUS version 2, time reference status 0
//          7, 8  service type, subtype
//          9,10  message type counter
//         11,12  destination
//         13..19 time, CUC: 4 octets of seconds, 3 of 2^-24 s (P-field implicit)
//         20..   source data
//         last 2 CRC-16/CCITT-FALSE over all octets before
#pragma once

#include <cstdint>

#include "core/span.hpp"

namespace berth {

constexpr std::int32_t kPrimaryHeaderBytes = 6;
constexpr std::int32_t kSecondaryHeaderBytes = 14;
constexpr std::int32_t kDataOffset = kPrimaryHeaderBytes + kSecondaryHeaderBytes;
constexpr std::int32_t kCrcBytes = 2;
constexpr std::int32_t kMaxPacketBytes = 512;
constexpr std::int32_t kMaxSourceBytes = kMaxPacketBytes - kDataOffset - kCrcBytes;

/// CUC time with 4 + 3 octets.
struct CucTime {
  std::uint32_t seconds = 0;
  std::uint32_t fraction = 0;  // 2^-24 s, 0 .. 2^24 - 1

  friend constexpr bool operator==(CucTime a, CucTime b) {
    return a.seconds == b.seconds && a.fraction == b.fraction;
  }
};

/// Microseconds to CUC, fraction rounded down. Range: up to 2^32 s; wraps beyond.
CucTime cuc_from_us(std::uint64_t time_us);

struct PacketHeader {
  std::uint16_t apid = 0;            // 11 bits
  std::uint16_t sequence_count = 0;  // 14 bits, per APID
  std::uint8_t service = 0;
  std::uint8_t subtype = 0;
  std::uint16_t message_count = 0;  // per service and subtype
  std::uint16_t destination = 0;
  CucTime time;
};

/// Why a packet was refused.
enum class PacketError : std::uint8_t {
  kNone = 0,
  kLineCode,        // not a frame of the line code
  kTooShort,        // shorter than its headers
  kLengthMismatch,  // length field and octets disagree
  kCrc,             // corrupted on the way
  kHeader,          // not an unsegmented telemetry packet with a PUS-C header
  kWrongType,       // another service or subtype than asked for
  kContent          // a field outside its range, or the wrong number of octets
};

/// Name in snake case for messages.
const char* packet_error_name(PacketError error);

/// Puts header and CRC around the source data that already stands at packet[kDataOffset].
/// Returns the whole packet's size, or 0 when it does not fit. APID and sequence count are masked.
std::int32_t encode_packet(const PacketHeader& header, std::int32_t source_bytes,
                           Span<std::uint8_t> packet);

/// Checks a packet and takes its header; `source` becomes the source data within `packet`. On an
/// error the outputs are untouched.
PacketError decode_packet(Span<const std::uint8_t> packet, PacketHeader& header,
                          Span<const std::uint8_t>& source);

}  // namespace berth
