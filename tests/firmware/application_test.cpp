#include "app/application.hpp"

#include <gtest/gtest.h>

#include "board_fixture.hpp"

namespace berth {
namespace {

TEST(Application, answers_every_frame_in_order) {
  test::OnHostBoard board;
  for (std::uint32_t i = 0; i < 5; ++i) board.add_grey_frame(10 + i, 64, 48);
  EXPECT_EQ(board.run(), ApplicationEnd::kEndOfStream);
  const host::Telemetry telemetry = board.telemetry();
  ASSERT_EQ(telemetry.frames.size(), 5u);
  for (std::uint32_t i = 0; i < 5; ++i) {
    EXPECT_EQ(telemetry.frames[i].pose.frame_index, 10 + i);
    EXPECT_FALSE(telemetry.frames[i].pose.valid);
    EXPECT_NE(telemetry.frames[i].pose.reason, Reason::kNone);
    ASSERT_TRUE(telemetry.frames[i].platform.has_value());
  }
  ASSERT_EQ(telemetry.boots.size(), 1u);
  EXPECT_EQ(telemetry.boots[0].parameter_code, 0);
}

TEST(Application, gives_bad_frame_for_what_is_not_the_cameras_picture) {
  test::OnHostBoard board;
  board.add_grey_frame(0, 48, 64);
  board.add_grey_frame(1, 640, 480);
  board.add_frame(2, 64, 48, {});                             // unreadable
  board.add_frame(3, 64, 48, std::vector<std::uint8_t>(99));  // cut short
  board.add_grey_frame(4, 2048, 2048);                        // larger than a buffer
  board.add_grey_frame(5, 64, 48);
  EXPECT_EQ(board.run(), ApplicationEnd::kEndOfStream);
  const host::Telemetry telemetry = board.telemetry();
  ASSERT_EQ(telemetry.frames.size(), 6u);
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(telemetry.frames[static_cast<std::size_t>(i)].pose.reason, Reason::kBadFrame);
  }
  EXPECT_NE(telemetry.frames[5].pose.reason, Reason::kBadFrame);
}

TEST(Application, refuses_a_damaged_parameter_block_and_says_so) {
  test::OnHostBoard board;
  hal::host::board().parameter_block[20] ^= 1;
  board.add_grey_frame(0, 64, 48);
  EXPECT_EQ(board.run(), ApplicationEnd::kParametersRefused);
  const host::Telemetry telemetry = board.telemetry();
  EXPECT_TRUE(telemetry.frames.empty());
  ASSERT_EQ(telemetry.boots.size(), 1u);
  EXPECT_EQ(telemetry.boots[0].parameter_code, static_cast<int>(BlockCode::kCrc));
  EXPECT_NE(telemetry.boots[0].parameter_text[0], '\0');
}

TEST(Application, says_that_it_has_no_parameters) {
  test::OnHostBoard board;
  hal::host::board().parameter_block.clear();
  EXPECT_EQ(board.run(), ApplicationEnd::kParametersRefused);
}

TEST(Application, ends_without_a_camera_and_when_it_fails) {
  test::OnHostBoard board;
  hal::host::board().has_camera = false;
  EXPECT_EQ(board.run(), ApplicationEnd::kNoCamera);
  hal::host::board().has_camera = true;
  hal::host::board().camera_fails_at_end = true;
  EXPECT_EQ(board.run(), ApplicationEnd::kCameraError);
}

TEST(Application, reports_the_fault_that_ended_the_boot_before_once) {
  test::OnHostBoard board;
  hal::host::board().fault = {hal::FaultKind::kMemoryProtection, 0x1234, 0, 0, 0, 0x60200000, 1};
  EXPECT_EQ(board.run(), ApplicationEnd::kEndOfStream);
  EXPECT_EQ(board.run(), ApplicationEnd::kEndOfStream);
  const host::Telemetry telemetry = board.telemetry();
  ASSERT_EQ(telemetry.faults.size(), 1u);
  EXPECT_EQ(telemetry.faults[0].record.kind, hal::FaultKind::kMemoryProtection);
  EXPECT_EQ(telemetry.faults[0].record.fault_address, 0x60200000u);
}

}  // namespace
}  // namespace berth
