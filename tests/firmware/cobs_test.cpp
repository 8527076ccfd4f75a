#include "tmtc/cobs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace berth {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes encode(const Bytes& payload) {
  Bytes line(static_cast<std::size_t>(cobs_bound(static_cast<std::int32_t>(payload.size()))));
  const std::int32_t size = cobs_encode(payload, line);
  EXPECT_GT(size, 0);
  line.resize(static_cast<std::size_t>(size));
  return line;
}

// Decodes with the closing zero taken off; `capacity` bytes of room.
std::int32_t decode(const Bytes& line, Bytes& payload, std::size_t capacity = 2048) {
  payload.assign(capacity, 0xee);
  const std::int32_t size =
      cobs_decode(Span<const std::uint8_t>(line).first(line.size() - 1), payload);
  if (size >= 0) payload.resize(static_cast<std::size_t>(size));
  return size;
}

Bytes ramp(int first, int last) {
  Bytes bytes;
  for (int value = first; value <= last; ++value) bytes.push_back(static_cast<std::uint8_t>(value));
  return bytes;
}

Bytes joined(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// The examples of the paper's successors, as in Wikipedia's table of COBS encodings.
TEST(Cobs, encodes_the_published_examples) {
  EXPECT_EQ(encode({0x00}), (Bytes{1, 1, 0}));
  EXPECT_EQ(encode({0x00, 0x00}), (Bytes{1, 1, 1, 0}));
  EXPECT_EQ(encode({0x00, 0x11, 0x00}), (Bytes{1, 2, 0x11, 1, 0}));
  EXPECT_EQ(encode({0x11, 0x22, 0x00, 0x33}), (Bytes{3, 0x11, 0x22, 2, 0x33, 0}));
  EXPECT_EQ(encode({0x11, 0x00, 0x00, 0x00}), (Bytes{2, 0x11, 1, 1, 1, 0}));
  EXPECT_EQ(encode(ramp(1, 254)), joined(joined({0xff}, ramp(1, 254)), {0}));
  EXPECT_EQ(encode(ramp(0, 254)), joined(joined({1, 0xff}, ramp(1, 254)), {0}));
  EXPECT_EQ(encode(ramp(1, 255)), joined(joined({0xff}, ramp(1, 254)), {2, 0xff, 0}));
  EXPECT_EQ(encode(joined(ramp(2, 255), {0})), joined(joined({0xff}, ramp(2, 255)), {1, 1, 0}));
  EXPECT_EQ(encode(joined(ramp(3, 255), {0, 1})), joined(joined({0xfe}, ramp(3, 255)), {2, 1, 0}));
}

TEST(Cobs, round_trips_every_length_around_the_block_size) {
  std::mt19937 random(1);
  for (int size = 0; size <= 600; ++size) {
    for (const unsigned zero_share : {0u, 1u, 128u, 256u}) {
      Bytes payload(static_cast<std::size_t>(size));
      for (auto& byte : payload) {
        const auto value = static_cast<std::uint8_t>(random());
        byte = random() % 256 < zero_share ? std::uint8_t{0} : std::max<std::uint8_t>(value, 1);
      }
      const Bytes line = encode(payload);
      ASSERT_EQ(std::count(line.begin(), line.end(), 0), 1);
      Bytes back;
      ASSERT_EQ(decode(line, back), size);
      ASSERT_EQ(back, payload);
    }
  }
}

TEST(Cobs, refuses_what_no_encoder_makes) {
  Bytes payload;
  EXPECT_EQ(decode({5, 1, 2, 0}, payload), -1);        // block cut short
  EXPECT_EQ(decode({3, 1, 0, 2, 9, 0}, payload), -1);  // a zero inside a block
  EXPECT_EQ(decode({0, 1, 0}, payload), -1);           // a zero as a code
}

TEST(Cobs, never_writes_beyond_the_room) {
  Bytes line(cobs_bound(100) - 1);
  EXPECT_EQ(cobs_encode(Bytes(100, 7), line), 0);
  const Bytes encoded = encode(Bytes{1, 2, 0, 3});
  Bytes payload;
  for (std::size_t room = 0; room < 4; ++room) EXPECT_EQ(decode(encoded, payload, room), -1);
  EXPECT_EQ(decode(encoded, payload, 4), 4);
}

}  // namespace
}  // namespace berth
