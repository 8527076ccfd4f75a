#include "tmtc/packets.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "sample_packets.hpp"

namespace berth {
namespace {

using Bytes = std::vector<std::uint8_t>;

template <typename Packet>
Bytes encoded(const Packet& packet, std::int32_t (*encode)(const Packet&, Span<std::uint8_t>)) {
  Bytes source(kMaxSourceBytes);
  source.resize(static_cast<std::size_t>(encode(packet, source)));
  return source;
}

// Field by field equality by way of the octets is circular; these compare members that a mix-up
// of two fields of one type would swap, and octets for the rest.
template <typename Packet>
void expect_round_trip(const Packet& in, std::int32_t (*encode)(const Packet&, Span<std::uint8_t>),
                       PacketError (*decode)(Span<const std::uint8_t>, Packet&)) {
  const Bytes source = encoded(in, encode);
  ASSERT_GT(source.size(), 0u);
  Packet out;
  ASSERT_EQ(decode(source, out), PacketError::kNone);
  EXPECT_EQ(encoded(out, encode), source);
  for (std::size_t size = 0; size < source.size(); ++size) {
    EXPECT_NE(decode(Span<const std::uint8_t>(source).first(size), out), PacketError::kNone);
  }
  Bytes longer = source;
  longer.push_back(0);
  EXPECT_NE(decode(longer, out), PacketError::kNone);
  for (std::size_t room = 0; room < source.size(); room += 7) {
    Bytes small(room);
    EXPECT_EQ(encode(in, small), 0);
  }
}

std::int32_t word_at(const Bytes& source, int offset) {
  const auto* at = source.data() + offset;
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(at[0]) << 24 | at[1] << 16 |
                                   at[2] << 8 | at[3]);
}

TEST(PosePacketLayout, is_that_of_the_interface_document) {
  PosePacket p;
  p.frame_index = 0x01020304;
  p.valid = true;
  p.has_second = true;
  p.reason = Reason::kAmbiguous;
  p.markers_used = 7;
  p.camera_from_target.translation_mm[0] = q<18>(-1.5);
  p.camera_from_target.translation_mm[2] = q<18>(300.25);
  p.camera_from_target.rotation = {q<30>(0.5), q<30>(-0.5), q<30>(0.25), q<30>(1.0)};
  p.covariance.sigma_rotation[0] = q<28>(0.001);
  p.covariance.sigma_translation_mm[2] = q<18>(0.125);
  p.covariance.correlation[0] = q<30>(-1.0);
  p.covariance.correlation[14] = q<30>(0.75);
  p.residual_px = q<16>(0.01);
  p.ambiguity = q<30>(0.6);
  p.effector_from_latch.translation_mm[1] = q<18>(2000.0);
  p.effector_covariance.correlation[14] = q<30>(0.125);
  p.second.rotation.w = q<30>(0.875);
  p.second_residual_px = q<16>(0.02);
  const Bytes s = encoded(p, encode_pose);
  ASSERT_EQ(s.size(), 271u);
  EXPECT_EQ(word_at(s, 0), 0x01020304);
  EXPECT_EQ(s[4], 0x09);
  EXPECT_EQ(s[5], static_cast<int>(Reason::kAmbiguous));
  EXPECT_EQ(s[6], 7);
  EXPECT_EQ(word_at(s, 7), -1.5 * (1 << 18));
  EXPECT_EQ(word_at(s, 15), 300.25 * (1 << 18));
  EXPECT_EQ(word_at(s, 19), 1 << 29);
  EXPECT_EQ(word_at(s, 23), -(1 << 29));
  EXPECT_EQ(word_at(s, 27), 1 << 28);
  EXPECT_EQ(word_at(s, 31), 1 << 30);
  EXPECT_EQ(word_at(s, 35), std::lround(0.001 * (1 << 28)));
  EXPECT_EQ(word_at(s, 55), 1 << 15);
  EXPECT_EQ(word_at(s, 59), -(1 << 30));
  EXPECT_EQ(word_at(s, 115), 3 << 28);
  EXPECT_EQ(word_at(s, 119), std::lround(0.01 * (1 << 16)));
  EXPECT_EQ(word_at(s, 123), std::lround(0.6 * (1 << 30)));
  EXPECT_EQ(word_at(s, 131), 2000 << 18);
  EXPECT_EQ(word_at(s, 235), 1 << 27);
  EXPECT_EQ(word_at(s, 251), 7 << 27);
  EXPECT_EQ(word_at(s, 267), std::lround(0.02 * (1 << 16)));
}

TEST(MarkersPacketLayout, is_that_of_the_interface_document) {
  MarkersPacket p;
  p.frame_index = 9;
  p.set.count = 2;
  Marker& m = p.set.markers[1];
  m.kind = MarkerKind::kRing;
  m.index = 3;
  m.used = true;
  m.center_px = {q<16>(511.5), q<16>(-0.25)};
  m.variance_xx = q<24>(0.0001);
  m.variance_yy = q<24>(0.0002);
  m.bias_px = {q<16>(0.3), q<16>(-0.3)};
  const Bytes s = encoded(p, encode_markers);
  ASSERT_EQ(s.size(), 5u + 2 * 31);
  EXPECT_EQ(s[4], 2);
  EXPECT_EQ(s[36], 1);
  EXPECT_EQ(s[37], 3);
  EXPECT_EQ(s[38], 2);
  EXPECT_EQ(word_at(s, 39), 511.5 * 65536);
  EXPECT_EQ(word_at(s, 43), -16384);
  EXPECT_EQ(word_at(s, 47), std::lround(0.0001 * (1 << 24)));
  EXPECT_EQ(word_at(s, 51), 0);
  EXPECT_EQ(word_at(s, 55), std::lround(0.0002 * (1 << 24)));
  EXPECT_EQ(word_at(s, 59), std::lround(0.3 * 65536));
  EXPECT_EQ(word_at(s, 63), std::lround(-0.3 * 65536));
}

TEST(AlgorithmAndPlatformLayout, are_those_of_the_interface_document) {
  AlgorithmPacket a;
  a.digests[7] = 0x11223344;
  a.work_units = 0x01020304;
  a.tally.pose_candidates = 0x0506;
  a.tally.pools_full = 7;
  a.tally.targets = 2;
  a.roll = q<28>(-0.5);
  const Bytes algorithm = encoded(a, encode_algorithm);
  ASSERT_EQ(algorithm.size(), 80u);
  EXPECT_EQ(word_at(algorithm, 32), 0x11223344);
  EXPECT_EQ(word_at(algorithm, 36), 0x01020304);
  EXPECT_EQ(algorithm[58] << 8 | algorithm[59], 0x0506);
  EXPECT_EQ(algorithm[62], 7);
  EXPECT_EQ(algorithm[63], 2);
  EXPECT_EQ(word_at(algorithm, 76), -(1 << 27));
  PlatformPacket p;
  p.uptime_ticks = 0x0102030405060708;
  p.stage_ticks[7] = 77;
  p.stack_peak_bytes = 99;
  const Bytes platform = encoded(p, encode_platform);
  ASSERT_EQ(platform.size(), 62u);
  EXPECT_EQ(word_at(platform, 6), 0x01020304);
  EXPECT_EQ(word_at(platform, 10), 0x05060708);
  EXPECT_EQ(word_at(platform, 50), 77);
  EXPECT_EQ(word_at(platform, 58), 99);
}

TEST(Packets, round_trip_with_every_bit_pattern) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    expect_round_trip(test::random_pose(seed), encode_pose, decode_pose);
    expect_round_trip(test::random_markers(seed, static_cast<int>(seed) % (kMaxMarkers + 1)),
                      encode_markers, decode_markers);
    expect_round_trip(test::random_packet<AlgorithmPacket>(
                          seed, [](auto& io, auto& p) { visit_algorithm(io, p); }),
                      encode_algorithm, decode_algorithm);
    expect_round_trip(
        test::random_packet<PlatformPacket>(seed, [](auto& io, auto& p) { visit_platform(io, p); }),
        encode_platform, decode_platform);
    FrameEventPacket event{seed * 77, static_cast<Reason>(seed % 15), seed << 20};
    expect_round_trip(event, encode_frame_event, decode_frame_event);
    BootPacket boot;
    boot.boot_count = seed;
    boot.parameter_code = static_cast<std::uint8_t>(seed);
    std::strcpy(boot.parameter_text, "unknown section: ABCD");
    expect_round_trip(boot, encode_boot, decode_boot);
    FaultPacket fault;
    fault.record = {hal::FaultKind::kBus, seed, 2 * seed, 3 * seed, 4 * seed, 5 * seed, 6 * seed};
    expect_round_trip(fault, encode_fault, decode_fault);
  }
}

TEST(PosePacket, keeps_every_field_apart_on_the_way_back) {
  const PosePacket in = test::random_pose(7);
  PosePacket out;
  ASSERT_EQ(decode_pose(encoded(in, encode_pose), out), PacketError::kNone);
  EXPECT_EQ(out.frame_index, in.frame_index);
  EXPECT_EQ(out.valid, in.valid);
  EXPECT_EQ(out.identified, in.identified);
  EXPECT_EQ(out.has_pose, in.has_pose);
  EXPECT_EQ(out.has_second, in.has_second);
  EXPECT_EQ(out.reason, in.reason);
  EXPECT_EQ(out.markers_used, in.markers_used);
  EXPECT_EQ(out.camera_from_target.translation_mm[1], in.camera_from_target.translation_mm[1]);
  EXPECT_EQ(out.camera_from_target.rotation.z, in.camera_from_target.rotation.z);
  EXPECT_EQ(out.covariance.sigma_rotation[2], in.covariance.sigma_rotation[2]);
  EXPECT_EQ(out.covariance.correlation[7], in.covariance.correlation[7]);
  EXPECT_EQ(out.residual_px, in.residual_px);
  EXPECT_EQ(out.ambiguity, in.ambiguity);
  EXPECT_EQ(out.effector_from_latch.rotation.x, in.effector_from_latch.rotation.x);
  EXPECT_EQ(out.effector_covariance.sigma_translation_mm[0],
            in.effector_covariance.sigma_translation_mm[0]);
  EXPECT_EQ(out.second.translation_mm[2], in.second.translation_mm[2]);
  EXPECT_EQ(out.second_residual_px, in.second_residual_px);
}

TEST(Packets, with_a_value_outside_its_range_are_refused) {
  Bytes pose = encoded(test::random_pose(1), encode_pose);
  PosePacket untouched;
  pose[4] = 0x10;  // a flag that does not exist
  EXPECT_EQ(decode_pose(pose, untouched), PacketError::kContent);
  pose[4] = 0;
  pose[5] = static_cast<std::uint8_t>(Reason::kCount);
  EXPECT_EQ(decode_pose(pose, untouched), PacketError::kContent);
  EXPECT_EQ(untouched.frame_index, 0u);
  Bytes markers = encoded(test::random_markers(1, 2), encode_markers);
  MarkersPacket none;
  markers[4] = kMaxMarkers + 1;
  EXPECT_EQ(decode_markers(markers, none), PacketError::kContent);
  markers[4] = 2;
  markers[5] = 3;  // a kind that does not exist
  EXPECT_EQ(decode_markers(markers, none), PacketError::kContent);
}

TEST(Packets, of_another_event_or_structure_are_of_the_wrong_type) {
  FaultPacket fault;
  EXPECT_EQ(decode_fault(encoded(BootPacket{}, encode_boot), fault), PacketError::kWrongType);
  BootPacket boot;
  EXPECT_EQ(decode_boot(encoded(FrameEventPacket{}, encode_frame_event), boot),
            PacketError::kWrongType);
}

TEST(Packets, all_fit_the_longest_packet) {
  EXPECT_GT(encoded(test::random_markers(1, kMaxMarkers), encode_markers).size(), 0u);
  EXPECT_LE(encoded(test::random_pose(1), encode_pose).size(),
            static_cast<std::size_t>(kMaxSourceBytes));
}

}  // namespace
}  // namespace berth
