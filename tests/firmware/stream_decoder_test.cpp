#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "host_sim/decode/decode.hpp"
#include "sample_packets.hpp"
#include "tmtc/cobs.hpp"
#include "tmtc/line_writer.hpp"

namespace berth::host {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes sample_line(int frames) {
  Bytes buffer(static_cast<std::size_t>(frames) * 2048);
  LineWriter line(buffer);
  TelemetryChannel channel(kApidVision);
  for (int i = 0; i < frames; ++i) {
    const auto seed = static_cast<unsigned>(i);
    PosePacket pose = test::random_pose(seed);
    pose.frame_index = seed;
    MarkersPacket markers = test::random_markers(seed, i % 8);
    markers.frame_index = seed;
    AlgorithmPacket algorithm;
    algorithm.frame_index = seed;
    line.append(channel.next_header(kPoseType, {}), encode_pose(pose, line.source()));
    line.append(channel.next_header(kMarkersType, {}), encode_markers(markers, line.source()));
    line.append(channel.next_header(kAlgorithmType, {}),
                encode_algorithm(algorithm, line.source()));
  }
  return Bytes(line.bytes().begin(), line.bytes().end());
}

TEST(StreamDecoder, takes_bytes_in_any_portions) {
  const Bytes line = sample_line(4);
  for (const std::size_t portion : {std::size_t{1}, std::size_t{7}, line.size()}) {
    StreamDecoder decoder;
    std::vector<Packet> packets;
    for (std::size_t at = 0; at < line.size(); at += portion) {
      const std::size_t size = std::min(portion, line.size() - at);
      decoder.push(Span<const std::uint8_t>(line).subspan(at, size), packets);
    }
    EXPECT_EQ(packets.size(), 12u);
    EXPECT_EQ(decoder.refused(), 0);
    EXPECT_TRUE(decoder.is_at_frame_end());
  }
}

TEST(StreamDecoder, loses_only_the_damaged_packet) {
  const Bytes good = sample_line(4);
  for (std::size_t at = 0; at < good.size(); at += 3) {
    Bytes line = good;
    line[at] ^= 0x5a;
    StreamDecoder decoder;
    std::vector<Packet> packets;
    decoder.push(line, packets);
    EXPECT_GE(packets.size(), 10u) << at;  // a lost or a made-up zero costs two
    EXPECT_LT(packets.size(), 12u) << at;
    EXPECT_TRUE(decoder.refused() > 0 || !decoder.is_at_frame_end()) << at;
  }
}

TEST(StreamDecoder, survives_noise_without_a_packet) {
  std::mt19937 random(3);
  Bytes noise(300000);
  for (auto& byte : noise) byte = static_cast<std::uint8_t>(random());
  StreamDecoder decoder;
  std::vector<Packet> packets;
  decoder.push(noise, packets);
  EXPECT_TRUE(packets.empty());
  decoder.push(Bytes(100000, 0x01), packets);  // a line that has lost its zeros
  decoder.push(Bytes{0}, packets);
  decoder.push(sample_line(1), packets);
  EXPECT_EQ(packets.size(), 3u);
}

// The contents of a packet with a good CRC are still only bytes.
TEST(StreamDecoder, takes_random_contents_of_every_type_or_refuses_them) {
  std::mt19937 random(4);
  const PacketType types[] = {kPoseType,      kMarkersType,    kAlgorithmType, kPlatformType,
                              kBootEventType, kFrameEventType, kFaultEventType};
  Bytes buffer(1024);
  int taken = 0;
  for (int turn = 0; turn < 20000; ++turn) {
    LineWriter line(buffer);
    TelemetryChannel channel(kApidPlatform);
    const auto size = static_cast<std::int32_t>(1 + random() % kMaxSourceBytes);
    for (auto& byte : line.source()) byte = static_cast<std::uint8_t>(random() % 5);
    line.append(channel.next_header(types[turn % 7], {}), size);
    taken += decode_telemetry(line.bytes()).has_value();
  }
  EXPECT_LT(taken, 20000);
}

TEST(Telemetry, groups_the_packets_of_a_frame) {
  const auto telemetry = decode_telemetry(sample_line(3));
  ASSERT_TRUE(telemetry.has_value());
  ASSERT_EQ(telemetry->frames.size(), 3u);
  EXPECT_EQ(telemetry->frames[2].pose.frame_index, 2u);
  EXPECT_EQ(telemetry->frames[2].markers.set.count, 2);
  EXPECT_FALSE(telemetry->frames[2].platform.has_value());
}

TEST(Telemetry, says_what_is_wrong_in_one_line) {
  Bytes line = sample_line(2);
  line.pop_back();
  EXPECT_EQ(decode_telemetry(line).error(), "the telemetry is cut short");
  line = sample_line(2);
  *(std::find(line.begin(), line.end(), 0) - 1) ^= 0x40;  // in the CRC itself
  EXPECT_EQ(decode_telemetry(line).error(), "the telemetry has 1 damaged packets: crc");
  // Markers of a frame whose pose packet never came.
  line = sample_line(1);
  line.erase(line.begin(), std::find(line.begin(), line.end(), 0) + 1);
  EXPECT_EQ(decode_telemetry(line).error(), "unexpected telemetry packet (128, 2)");
}

}  // namespace
}  // namespace berth::host
