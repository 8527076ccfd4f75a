// Faults leave a record that survives the reset, and the next boot reports it.
#include <gtest/gtest.h>

#include <string>

#include "host_sim/decode/decode.hpp"
#include "host_sim/on_target/on_target.hpp"
#include "image/hazards.hpp"

namespace berth::host {
namespace {

Telemetry run(Hazard hazard) {
  TargetOptions options;
  options.image = BERTH_FIRMWARE_BUILD "/fault_image.elf";
  options.silence_timeout_s = 60;
  bool sent = false;
  const auto frames = [&](TargetFrame& frame) {
    frame.index = static_cast<std::uint32_t>(hazard);
    return !std::exchange(sent, true);
  };
  const auto line = run_on_target(frames, {}, options);
  EXPECT_TRUE(line.has_value()) << line.error();
  if (!line) return {};
  const auto telemetry = decode_telemetry(*line);
  EXPECT_TRUE(telemetry.has_value()) << telemetry.error();
  return telemetry ? *telemetry : Telemetry{};
}

hal::FaultRecord record_after(Hazard hazard) {
  const Telemetry telemetry = run(hazard);
  EXPECT_EQ(telemetry.boots.size(), 2u);
  EXPECT_EQ(telemetry.faults.size(), 1u);
  if (telemetry.boots.size() != 2 || telemetry.faults.size() != 1) return {};
  EXPECT_EQ(telemetry.boots[0].boot_count, 1u);
  EXPECT_EQ(telemetry.boots[1].boot_count, 2u);
  EXPECT_EQ(telemetry.faults[0].record.boot_count, 1u);
  return telemetry.faults[0].record;
}

void expect_protection_fault(Hazard hazard, std::uint32_t address) {
  const hal::FaultRecord record = record_after(hazard);
  EXPECT_EQ(record.kind, hal::FaultKind::kMemoryProtection);
  EXPECT_EQ(record.fault_address, address);
  EXPECT_GT(record.program_counter, 0u);
  EXPECT_LT(record.program_counter, kEndOfCode);
}

TEST(Faults, none_leaves_no_record) {
  const Telemetry telemetry = run(Hazard::kNone);
  EXPECT_EQ(telemetry.boots.size(), 1u);
  EXPECT_TRUE(telemetry.faults.empty());
}

TEST(Faults, access_outside_the_parts_memory) {
  expect_protection_fault(Hazard::kReadBehindData, kEndOfData);
  expect_protection_fault(Hazard::kReadBehindCode, kEndOfCode);
  expect_protection_fault(Hazard::kReadBehindFrames, kEndOfFrames);
  expect_protection_fault(Hazard::kUnusedPeripheral, kUnusedPeripheral);
}

TEST(Faults, write_to_a_frame_or_to_code) {
  expect_protection_fault(Hazard::kWriteToFrame, kFrames);
  expect_protection_fault(Hazard::kWriteToCode, 0);
}

TEST(Faults, stack_overflow_step_by_step_and_in_one_leap) {
  for (const Hazard hazard : {Hazard::kStackOverflow, Hazard::kStackLeap}) {
    const hal::FaultRecord record = record_after(hazard);
    EXPECT_EQ(record.kind, hal::FaultKind::kMemoryProtection);
    EXPECT_LT(record.stack_pointer, kStartOfData + 64);
  }
}

TEST(Faults, execution_of_data) {
  EXPECT_EQ(record_after(Hazard::kRunFromData).kind, hal::FaultKind::kMemoryProtection);
}

TEST(Faults, undefined_instruction_and_division_by_zero) {
  EXPECT_EQ(record_after(Hazard::kUndefinedInstruction).kind, hal::FaultKind::kUsage);
  EXPECT_EQ(record_after(Hazard::kDivideByZero).kind, hal::FaultKind::kUsage);
}

TEST(Faults, broken_contract) {
  EXPECT_EQ(record_after(Hazard::kBrokenContract).kind, hal::FaultKind::kTerminate);
}

TEST(Faults, hang_is_ended_by_the_watchdog) {
  EXPECT_EQ(record_after(Hazard::kHang).kind, hal::FaultKind::kWatchdog);
}

}  // namespace
}  // namespace berth::host
