#include "app/vision_task.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "board_fixture.hpp"

namespace berth {
namespace {

FrameResult result_with_pose() {
  FrameResult r;
  r.valid = r.identified = r.has_pose = true;
  r.reason = Reason::kNone;
  r.pose.camera_from_target.translation_mm = {Mm(1), Mm(2), Mm(300)};
  r.pose.markers_used = 6;
  r.pose.second.translation_mm = {Mm(9), Mm(9), Mm(9)};
  r.effector_from_latch.translation_mm = {Mm(4), Mm(5), Mm(6)};
  // A quarter turn about z.
  r.effector_from_latch.rotation << Unit(0), -Unit(1), Unit(0), Unit(1), Unit(0), Unit(0), Unit(0),
      Unit(0), Unit(1);
  return r;
}

hal::CameraFrame frame_at(std::uint32_t index) {
  hal::CameraFrame frame;
  frame.index = index;
  frame.mid_exposure_us = index * std::uint64_t{125000};
  return frame;
}

TEST(PosePacketOf, a_result_carries_the_pose_and_hides_what_is_not_there) {
  FrameResult r = result_with_pose();
  PosePacket p = make_pose_packet(5, r);
  EXPECT_EQ(p.frame_index, 5u);
  EXPECT_EQ(p.markers_used, 6);
  EXPECT_EQ(p.camera_from_target.translation_mm[2], Mm(300));
  EXPECT_EQ(p.camera_from_target.rotation.w, Unit(1));
  EXPECT_NEAR(p.effector_from_latch.rotation.w.raw(), 0.70710678 * (1 << 30), 16);
  EXPECT_NEAR(p.effector_from_latch.rotation.z.raw(), 0.70710678 * (1 << 30), 16);
  EXPECT_EQ(p.effector_from_latch.translation_mm[1], Mm(5));
  EXPECT_FALSE(p.has_second);
  EXPECT_EQ(p.second.translation_mm[0], Mm(0));
  r.pose.has_second = true;
  EXPECT_EQ(make_pose_packet(5, r).second.translation_mm[0], Mm(9));
  r.has_pose = r.valid = false;
  p = make_pose_packet(5, r);
  EXPECT_FALSE(p.has_second);
  EXPECT_EQ(p.markers_used, 0);
  EXPECT_EQ(p.camera_from_target.translation_mm[2], Mm(0));
}

TEST(FrameReporter, stamps_packets_with_the_frames_time_and_counts_them) {
  std::vector<std::uint8_t> buffer(2 * kFrameLineBytes);
  LineWriter line(buffer);
  FrameReporter reporter;
  reporter.report(frame_at(9), result_with_pose(), line);
  FrameResult failed;
  failed.reason = Reason::kNoLine;
  reporter.report(frame_at(10), failed, line);
  host::StreamDecoder decoder;
  std::vector<host::Packet> packets;
  decoder.push(line.bytes(), packets);
  ASSERT_EQ(packets.size(), 7u);  // an event for the frame without a pose only
  for (std::size_t i = 0; i < packets.size(); ++i) {
    EXPECT_EQ(packets[i].header.sequence_count, i);
    EXPECT_EQ(packets[i].header.apid, kApidVision);
  }
  EXPECT_EQ(packets[0].header.time, (CucTime{1, 1u << 21}));  // 9 * 125 ms
  EXPECT_EQ(packets[3].header.time, (CucTime{1, 1u << 22}));
  EXPECT_EQ(packets[3].header.message_count, 1);
  const auto event = host::decode_frame_event(packets[6]);
  ASSERT_TRUE(event.has_value());
  EXPECT_EQ(event->reason, Reason::kNoLine);
  EXPECT_EQ(event->frame_index, 10u);
}

TEST(VisionTask, gives_the_same_packets_whatever_came_before_but_for_their_counters) {
  const Parameters parameters = test::small_parameters();
  const auto workspace = std::make_unique<Workspace>();
  const auto result = std::make_unique<FrameResult>();
  std::vector<std::uint8_t> buffer(kFrameLineBytes), pixels(64 * 48, 100);
  LineWriter line(buffer);
  hal::CameraFrame frame = frame_at(3);
  frame.status = hal::FrameStatus::kComplete;
  frame.width = 64;
  frame.height = 48;
  frame.pixels = pixels;
  VisionTask task(parameters, {*workspace, *result, line});
  const auto sources_of = [&](VisionTask& t) {
    host::StreamDecoder decoder;
    std::vector<host::Packet> packets;
    decoder.push(t.on_frame(frame), packets);
    std::vector<std::vector<std::uint8_t>> sources;
    for (const auto& packet : packets) {
      sources.emplace_back(packet.source().begin(), packet.source().end());
    }
    return sources;
  };
  const auto first = sources_of(task);
  EXPECT_EQ(first.size(), 4u);
  task.on_frame(frame_at(4));
  EXPECT_EQ(sources_of(task), first);
}

}  // namespace
}  // namespace berth
