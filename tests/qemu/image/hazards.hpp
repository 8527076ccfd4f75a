// The hazards that the fault image knows, and the addresses they touch.
#pragma once

#include <cstdint>

namespace berth {

enum class Hazard : std::uint32_t {
  kNone = 0,
  kReadBehindData,
  kReadBehindCode,
  kReadBehindFrames,
  kWriteToFrame,
  kWriteToCode,
  kUnusedPeripheral,
  kStackOverflow,
  kStackLeap,
  kRunFromData,
  kUndefinedInstruction,
  kDivideByZero,
  kBrokenContract,
  kHang,
  kCount
};

constexpr std::uint32_t kEndOfCode = 0x00020000;
constexpr std::uint32_t kStartOfData = 0x20000000;
constexpr std::uint32_t kEndOfData = 0x20060000;
constexpr std::uint32_t kFrames = 0x60000000;
constexpr std::uint32_t kEndOfFrames = 0x60200000;
constexpr std::uint32_t kUnusedPeripheral = 0x40000000;  // timer 0

}  // namespace berth
