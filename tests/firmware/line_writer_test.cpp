#include "tmtc/line_writer.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "host_sim/decode/decode.hpp"

namespace berth {
namespace {

TEST(TelemetryChannel, counts_packets_per_channel_and_messages_per_type) {
  TelemetryChannel channel(0x42);
  EXPECT_EQ(channel.next_header({1, 1}, {}).message_count, 0);
  EXPECT_EQ(channel.next_header({1, 2}, {}).message_count, 0);
  const PacketHeader third = channel.next_header({1, 1}, {3, 4});
  EXPECT_EQ(third.apid, 0x42);
  EXPECT_EQ(third.sequence_count, 2);
  EXPECT_EQ(third.message_count, 1);
  EXPECT_EQ(third.service, 1);
  EXPECT_EQ(third.time, (CucTime{3, 4}));
}

TEST(TelemetryChannel, wraps_the_sequence_count_at_14_bits) {
  TelemetryChannel channel(1);
  for (int i = 0; i < 0x3fff; ++i) channel.next_header({1, 1}, {});
  EXPECT_EQ(channel.next_header({1, 1}, {}).sequence_count, 0x3fff);
  EXPECT_EQ(channel.next_header({1, 1}, {}).sequence_count, 0);
}

TEST(LineWriter, appends_packets_that_come_back_in_order) {
  std::vector<std::uint8_t> buffer(2048);
  LineWriter line(buffer);
  TelemetryChannel channel(kApidVision);
  for (std::uint32_t index = 0; index < 3; ++index) {
    const FrameEventPacket event{index, Reason::kNoCircle, 7};
    ASSERT_TRUE(line.append(channel.next_header(kFrameEventType, {}),
                            encode_frame_event(event, line.source())));
  }
  host::StreamDecoder decoder;
  std::vector<host::Packet> packets;
  decoder.push(line.bytes(), packets);
  ASSERT_EQ(packets.size(), 3u);
  for (std::uint32_t index = 0; index < 3; ++index) {
    EXPECT_EQ(host::decode_frame_event(packets[index])->frame_index, index);
    EXPECT_EQ(packets[index].header.sequence_count, index);
  }
  line.clear();
  EXPECT_TRUE(line.bytes().empty());
}

TEST(LineWriter, drops_a_packet_whole_when_the_buffer_is_full) {
  std::vector<std::uint8_t> buffer(100);
  LineWriter line(buffer);
  TelemetryChannel channel(kApidVision);
  const FrameEventPacket event{1, Reason::kNoCircle, 7};
  int appended = 0;
  for (int i = 0; i < 10; ++i) {
    appended += line.append(channel.next_header(kFrameEventType, {}),
                            encode_frame_event(event, line.source()));
  }
  EXPECT_GT(appended, 0);
  EXPECT_LT(appended, 10);
  const auto telemetry = host::decode_telemetry(line.bytes());
  EXPECT_TRUE(telemetry.has_value());
  EXPECT_FALSE(line.append(channel.next_header(kPoseType, {}), 0));
}

}  // namespace
}  // namespace berth
