#include "tmtc/space_packet.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

#include "tmtc/crc16.hpp"

namespace berth {
namespace {

using Bytes = std::vector<std::uint8_t>;

PacketHeader header_of(std::uint16_t apid, std::uint16_t sequence) {
  PacketHeader header;
  header.apid = apid;
  header.sequence_count = sequence;
  header.service = 128;
  header.subtype = 1;
  header.message_count = 0x1234;
  header.destination = 0x5678;
  header.time = {0x01020304, 0xa0b0c0};
  return header;
}

Bytes packet_of(const PacketHeader& header, const Bytes& source) {
  Bytes packet(kMaxPacketBytes, 0xee);
  std::copy(source.begin(), source.end(), packet.begin() + kDataOffset);
  const auto size = encode_packet(header, static_cast<std::int32_t>(source.size()), packet);
  EXPECT_EQ(size, kDataOffset + static_cast<std::int32_t>(source.size()) + kCrcBytes);
  packet.resize(static_cast<std::size_t>(size));
  return packet;
}

PacketError decode(const Bytes& packet, PacketHeader& header) {
  Span<const std::uint8_t> source;
  return decode_packet(packet, header, source);
}

TEST(Crc16, gives_the_check_values_of_ccitt_false) {
  const Bytes digits{'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  EXPECT_EQ(crc16(digits), 0x29b1);
  EXPECT_EQ(crc16(Bytes{}), 0xffff);
  // ECSS-E-ST-70-41C, B.1.5: verification of compliance.
  EXPECT_EQ(crc16(Bytes{0x00, 0x00}), 0x1d0f);
  EXPECT_EQ(crc16(Bytes{0x00, 0x00, 0x00}), 0xcc9c);
  EXPECT_EQ(crc16(Bytes{0xab, 0xcd, 0xef, 0x01}), 0x04a2);
  EXPECT_EQ(crc16(Bytes{0x14, 0x56, 0xf8, 0x9a, 0x00, 0x01}), 0x7fd5);
}

TEST(SpacePacket, lays_every_field_where_the_standards_say) {
  const Bytes packet = packet_of(header_of(0x0b0, 5), {0xde, 0xad});
  const Bytes head{0x08, 0xb0,                                // TM, secondary header, APID
                   0xc0, 0x05,                                // unsegmented, count
                   0x00, 0x11,                                // 18 octets follow, minus one
                   0x20, 128,  1,                             // PUS-C, service, subtype
                   0x12, 0x34, 0x56, 0x78,                    // message count, destination
                   0x01, 0x02, 0x03, 0x04, 0xa0, 0xb0, 0xc0,  // CUC time
                   0xde, 0xad};
  ASSERT_EQ(packet.size(), head.size() + 2);
  EXPECT_EQ(Bytes(packet.begin(), packet.end() - 2), head);
  EXPECT_EQ(packet[22] << 8 | packet[23], crc16(head));
}

TEST(SpacePacket, masks_what_exceeds_a_field_and_moves_no_other_bit) {
  const Bytes zero = packet_of(header_of(0, 0), {});
  for (const auto& [apid, sequence] : {std::pair{0x7ff, 0}, {0, 0x3fff}, {0xffff, 0xffff}}) {
    const Bytes packet = packet_of(
        header_of(static_cast<std::uint16_t>(apid), static_cast<std::uint16_t>(sequence)), {});
    EXPECT_EQ(packet[0] ^ zero[0], apid >> 8 & 0x07);
    EXPECT_EQ(packet[1] ^ zero[1], apid & 0xff);
    EXPECT_EQ(packet[2] ^ zero[2], sequence >> 8 & 0x3f);
    EXPECT_EQ(packet[3] ^ zero[3], sequence & 0xff);
    EXPECT_EQ(Bytes(packet.begin() + 4, packet.end() - 2), Bytes(zero.begin() + 4, zero.end() - 2));
  }
}

TEST(SpacePacket, round_trips_the_boundaries_of_every_field) {
  for (const std::uint32_t pattern : {0u, 1u, 0x55555555u, 0xaaaaaaaau, 0xffffffffu}) {
    PacketHeader in;
    in.apid = pattern & 0x7ff;
    in.sequence_count = pattern & 0x3fff;
    in.service = static_cast<std::uint8_t>(pattern);
    in.subtype = static_cast<std::uint8_t>(pattern);
    in.message_count = static_cast<std::uint16_t>(pattern);
    in.destination = static_cast<std::uint16_t>(pattern);
    in.time = {pattern, pattern & 0xffffff};
    PacketHeader out;
    ASSERT_EQ(decode(packet_of(in, {1}), out), PacketError::kNone);
    EXPECT_EQ(out.apid, in.apid);
    EXPECT_EQ(out.sequence_count, in.sequence_count);
    EXPECT_EQ(out.service, in.service);
    EXPECT_EQ(out.subtype, in.subtype);
    EXPECT_EQ(out.message_count, in.message_count);
    EXPECT_EQ(out.destination, in.destination);
    EXPECT_EQ(out.time, in.time);
  }
}

TEST(SpacePacket, takes_source_data_from_none_to_the_most_that_fits) {
  for (const int size : {0, 1, 2, kMaxSourceBytes}) {
    Bytes source(static_cast<std::size_t>(size));
    std::iota(source.begin(), source.end(), std::uint8_t{1});
    const Bytes packet = packet_of(header_of(1, 2), source);
    PacketHeader header;
    Span<const std::uint8_t> back;
    ASSERT_EQ(decode_packet(packet, header, back), PacketError::kNone);
    EXPECT_EQ(Bytes(back.begin(), back.end()), source);
  }
  Bytes packet(kMaxPacketBytes);
  EXPECT_EQ(encode_packet(header_of(1, 2), kMaxSourceBytes + 1, packet), 0);
  EXPECT_EQ(encode_packet(header_of(1, 2), -1, packet), 0);
}

TEST(SpacePacket, refuses_every_single_flipped_bit) {
  const Bytes good = packet_of(header_of(0x0b0, 77), {1, 2, 3, 4, 5});
  for (std::size_t bit = 0; bit < good.size() * 8; ++bit) {
    Bytes bad = good;
    bad[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
    PacketHeader header;
    EXPECT_NE(decode(bad, header), PacketError::kNone) << "bit " << bit;
  }
}

TEST(SpacePacket, refuses_truncation_and_extension_and_leaves_the_outputs_alone) {
  const Bytes good = packet_of(header_of(0x0b0, 77), Bytes(40, 9));
  PacketHeader header;
  header.apid = 0x123;
  for (std::size_t size = 0; size < good.size(); ++size) {
    EXPECT_NE(decode(Bytes(good.begin(), good.begin() + static_cast<long>(size)), header),
              PacketError::kNone);
  }
  Bytes longer = good;
  longer.push_back(0);
  EXPECT_EQ(decode(longer, header), PacketError::kLengthMismatch);
  EXPECT_EQ(header.apid, 0x123);
}

TEST(SpacePacket, refuses_other_kinds_of_packets_by_their_header) {
  const auto with_octet = [](std::size_t at, std::uint8_t value) {
    Bytes packet = packet_of(header_of(0x0b0, 77), {1, 2});
    packet[at] = value;
    const std::uint16_t crc = crc16(Span<const std::uint8_t>(packet).first(packet.size() - 2));
    packet[packet.size() - 2] = static_cast<std::uint8_t>(crc >> 8);
    packet[packet.size() - 1] = static_cast<std::uint8_t>(crc);
    PacketHeader header;
    return decode(packet, header);
  };
  EXPECT_EQ(with_octet(0, 0x08), PacketError::kNone);
  EXPECT_EQ(with_octet(0, 0x18), PacketError::kHeader);  // telecommand
  EXPECT_EQ(with_octet(0, 0x28), PacketError::kHeader);  // another version
  EXPECT_EQ(with_octet(0, 0x00), PacketError::kHeader);  // no secondary header
  EXPECT_EQ(with_octet(2, 0x40), PacketError::kHeader);  // first segment
  EXPECT_EQ(with_octet(6, 0x10), PacketError::kHeader);  // PUS-A
}

}  // namespace
}  // namespace berth
