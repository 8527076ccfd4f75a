// The parameter block as bytes: round trip, damage, truncation, sections.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "app/crc32.hpp"
#include "app/parameter_block.hpp"
#include "block_tools.hpp"

namespace berth::test {
namespace {

TEST(Crc32, HasTheCheckValueOfIeee8023) {
  const std::string text = "123456789";
  const std::vector<std::uint8_t> bytes(text.begin(), text.end());
  EXPECT_EQ(crc32(bytes), 0xCBF43926u);
}

TEST(ParameterBlock, RoundTripGivesTheSameBytes) {
  const std::vector<std::uint8_t> block = default_block();
  Parameters decoded;
  ASSERT_TRUE(decode_parameter_block(block, decoded).is_ok());
  EXPECT_EQ(encoded(decoded), block);
}

TEST(ParameterBlock, HoldsTheValuesLittleEndianAtTheDocumentedPlaces) {
  const std::vector<std::uint8_t> block = default_block();
  EXPECT_EQ(std::string(block.begin(), block.begin() + 4), "BPAR");
  EXPECT_EQ(read_word(block, 4), 0x00050002u);  // version 2, five sections
  EXPECT_EQ(read_word(block, 8), block.size());
  EXPECT_EQ(block.size(), 364u + sizeof(Thresholds));
  EXPECT_EQ(std::string(block.begin() + 12, block.begin() + 16), "CAMR");
  EXPECT_EQ(read_word(block, 16), 44u);
  EXPECT_EQ(read_word(block, 20), 1024u);        // width
  EXPECT_EQ(read_word(block, 28), 1250u << 16);  // fx
  EXPECT_EQ(read_word(block, 44), 0xFFE147AEu);  // k1 = -0.12 in Q24: -2013266 rounded
  EXPECT_EQ(std::string(block.begin() + 64, block.begin() + 68), "TRGT");
  EXPECT_EQ(read_word(block, 72), 120u << 18);  // plate width
}

TEST(ParameterBlock, EveryCorruptedByteIsRefused) {
  const std::vector<std::uint8_t> block = default_block();
  for (std::size_t at = 0; at < block.size(); ++at) {
    for (int mask = 1; mask < 256; ++mask) {
      std::vector<std::uint8_t> damaged = block;
      damaged[at] = static_cast<std::uint8_t>(damaged[at] ^ mask);
      Parameters out;
      ASSERT_FALSE(decode_parameter_block(damaged, out).is_ok()) << "byte " << at;
    }
  }
}

TEST(ParameterBlock, EveryTruncatedOrPaddedLengthIsRefused) {
  const std::vector<std::uint8_t> block = default_block();
  for (std::size_t size = 0; size < block.size(); ++size) {
    // A copy of its own size, so that a sanitizer sees a read past its end.
    const std::vector<std::uint8_t> cut(block.begin(), block.begin() + size);
    Parameters out;
    ASSERT_FALSE(decode_parameter_block(cut, out).is_ok()) << size;
  }
  std::vector<std::uint8_t> longer = block;
  longer.push_back(0);
  EXPECT_EQ(decoded_code(longer), BlockCode::kLength);
}

TEST(ParameterBlock, TruncationWithAFittingLengthAndCrcIsRefusedToo) {
  const std::vector<std::uint8_t> block = default_block();
  for (std::size_t size = 16; size < block.size(); ++size) {
    std::vector<std::uint8_t> cut(block.begin(), block.begin() + size);
    seal(cut);
    ASSERT_NE(decoded_code(cut), BlockCode::kOk) << size;
  }
}

TEST(ParameterBlock, OutputsAreUntouchedOnError) {
  std::vector<std::uint8_t> block = default_block();
  Parameters out = default_parameters();
  out.camera.width = 77;
  const std::vector<std::uint8_t> before = encoded(out);
  block[100] ^= 1;
  EXPECT_FALSE(decode_parameter_block(block, out).is_ok());
  EXPECT_EQ(encoded(out), before);
}

TEST(ParameterBlock, WrongVersionIsNamed) {
  std::vector<std::uint8_t> block = default_block();
  block[4] = 3;
  EXPECT_EQ(decoded_text(block), "CRC does not match: the block is damaged");
  seal(block);
  EXPECT_EQ(decoded_text(block), "version is not supported");
}

TEST(ParameterBlock, UnknownSectionIsNamed) {
  std::vector<std::uint8_t> block = default_block();
  rename_section(block, 64, "abcd");
  EXPECT_EQ(decoded_text(block), "unknown section \"abcd\"");
  rename_section(block, 64, "a\n\x80z");
  EXPECT_EQ(decoded_text(block), "unknown section \"a??z\"");
}

TEST(ParameterBlock, UnknownSectionIsRefusedThoughAllOthersArePresent) {
  std::vector<std::uint8_t> block = default_block();
  block.insert(block.end() - 4, {'n', 'e', 'w', '1', 0, 0, 0, 0});
  block[6] = 6;
  seal(block);
  EXPECT_EQ(decoded_text(block), "unknown section \"new1\"");
}

TEST(ParameterBlock, MissingAndDoubleSectionsAreNamed) {
  std::vector<std::uint8_t> twice = default_block();
  rename_section(twice, 64, "CAMR");
  EXPECT_EQ(decoded_text(twice), "section stands twice \"CAMR\"");
  std::vector<std::uint8_t> missing = default_block();
  missing.erase(missing.begin() + 12, missing.begin() + 12 + 8 + 44);
  missing[6] = 3;
  seal(missing);
  EXPECT_EQ(decoded_text(missing), "missing section \"CAMR\"");
}

TEST(ParameterBlock, SectionsMayStandInAnyOrder) {
  std::vector<std::uint8_t> block = default_block();
  std::rotate(block.begin() + 12, block.begin() + 12 + 8 + 44, block.end() - 4);
  seal(block);
  Parameters out;
  ASSERT_TRUE(decode_parameter_block(block, out).is_ok());
  EXPECT_EQ(encoded(out), default_block());
}

TEST(ParameterBlock, SectionOfWrongLengthIsNamed) {
  for (const int change : {-4, -1, 1, 4}) {
    std::vector<std::uint8_t> block = default_block();
    if (change > 0) block.insert(block.begin() + 64, static_cast<std::size_t>(change), 0);
    if (change < 0) block.erase(block.begin() + 64 + change, block.begin() + 64);
    write_word(block, 16, static_cast<std::uint32_t>(44 + change));
    seal(block);
    EXPECT_EQ(decoded_text(block), "wrong length of section \"CAMR\"") << change;
  }
}

TEST(ParameterBlock, RandomBytesNeverDecodeAndNeverReadOutside) {
  std::mt19937 random(1);
  const std::vector<std::uint8_t> block = default_block();
  for (int round = 0; round < 20000; ++round) {
    std::vector<std::uint8_t> bytes(random() % 600);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
    ASSERT_NE(decoded_code(bytes), BlockCode::kOk);
  }
  // Sealed damage reaches the sections and the validation; whatever is accepted encodes to itself.
  for (int round = 0; round < 10000; ++round) {
    std::vector<std::uint8_t> bytes = block;
    const unsigned count = 1 + random() % 4;
    for (unsigned i = 0; i < count; ++i) {
      bytes[4 + random() % (bytes.size() - 8)] = static_cast<std::uint8_t>(random());
    }
    seal(bytes);
    Parameters out;
    if (decode_parameter_block(bytes, out).is_ok()) {
      ASSERT_EQ(encoded(out), bytes);
    }
  }
}

TEST(ParameterBlock, ShortOutputSpansGetNothing) {
  const Parameters parameters = default_parameters();
  std::vector<std::uint8_t> small(default_block().size() - 1);
  EXPECT_EQ(encode_parameter_block(parameters, small), 0u);
  EXPECT_EQ(small, std::vector<std::uint8_t>(small.size()));
}

TEST(ParameterBlock, TextsFitAnySpan) {
  BlockStatus status;
  status.code = BlockCode::kOutOfRange;
  status.fault = {"target.dots[].collar_radius_mm", 7};
  char text[12];
  EXPECT_STREQ(describe(status, text), "value out o");
  EXPECT_STREQ(describe(status, {}), "");
  char enough[kBlockText_bytes];
  EXPECT_STREQ(describe(status, enough), "value out of range: target.dots[7].collar_radius_mm");
}

}  // namespace
}  // namespace berth::test
