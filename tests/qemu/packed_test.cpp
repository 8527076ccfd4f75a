// The packed operations on the core: intrinsics, their twins and the host agree bit for bit.
#include <gtest/gtest.h>

#include "host_sim/on_target/on_target.hpp"
#include "tests/image/packed_sweep.hpp"

namespace berth::host {
namespace {

std::uint32_t word_at(const std::vector<std::uint8_t>& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | bytes[at + i];
  return value;
}

TEST(Packed, IntrinsicsOnTheCoreEqualTheHost) {
  TargetOptions options;
  options.image = BERTH_FIRMWARE_BUILD "/packed_image.elf";
  options.silence_timeout_s = 60;
  const auto line = run_on_target([](TargetFrame&) { return false; }, {}, options);
  ASSERT_TRUE(line.has_value()) << line.error();
  ASSERT_EQ(line->size(), static_cast<std::size_t>(kPackedRecordBytes * kPackedSweepCount));
  for (std::size_t k = 0; k < kPackedSweepCount; ++k) {
    std::uint32_t unused = 0;
    EXPECT_EQ(word_at(*line, kPackedRecordBytes * k), kPackedSweeps[k].run(unused))
        << kPackedSweeps[k].name;
    EXPECT_EQ(word_at(*line, kPackedRecordBytes * k + 4), 0u) << kPackedSweeps[k].name;
  }
}

}  // namespace
}  // namespace berth::host
