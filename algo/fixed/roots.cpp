// See roots.hpp.
#include "fixed/roots.hpp"

namespace berth {
namespace {

// floor(sqrt(value)) of 16 bits, by trial of its 8 bits.
std::uint32_t root16(std::uint32_t value) {
  std::uint32_t root = 0;
  for (std::uint32_t bit = 0x80; bit != 0; bit >>= 1) {
    const std::uint32_t trial = root | bit;
    if (trial * trial <= value) root = trial;
  }
  return root;
}

// floor(sqrt(value)), value >= 2^30: upper half by root16, lower half by division.
std::uint32_t root32(std::uint32_t value) {
  const std::uint32_t upper = root16(value >> 16);
  const std::uint32_t rest = (value >> 16) - upper * upper;  // at most 2 upper
  std::uint32_t lower = ((rest << 7) + ((value >> 9) & 0x7f)) / upper;
  if (lower > 0xff) lower = 0xff;
  const std::uint32_t root = (upper << 8) + lower;
  return root * root > value ? root - 1 : root;
}

// floor(sqrt(value)), value >= 2^62: the same step once more.
std::uint32_t root64(std::uint64_t value) {
  const auto high = static_cast<std::uint32_t>(value >> 32);
  const std::uint32_t upper = root32(high);
  const std::uint32_t rest = high - upper * upper;  // at most 2 upper < 2^17
  const auto next = static_cast<std::uint32_t>(value >> 17) & 0x7fffu;
  std::uint32_t lower = ((rest << 15) + next) / upper;  // the sum is below 2^32
  if (lower > 0xffff) lower = 0xffff;
  const std::uint32_t root = (upper << 16) + lower;
  return std::uint64_t{root} * root > value ? root - 1 : root;
}

}  // namespace

std::uint32_t isqrt(std::uint64_t value) {
  if (value == 0) return 0;
  const int shift = leading_zeros64(value) & ~1;
  return root64(value << shift) >> (shift / 2);
}

std::uint32_t isqrt_nearest(std::uint64_t value) {
  const std::uint32_t root = isqrt(value);
  const std::uint64_t rest = value - std::uint64_t{root} * root;
  return rest > root && root != UINT32_MAX ? root + 1 : root;
}

std::uint32_t hypot(std::int32_t x, std::int32_t y) {
  const std::uint64_t xx = static_cast<std::uint64_t>(std::int64_t{x} * x);
  const std::uint64_t yy = static_cast<std::uint64_t>(std::int64_t{y} * y);
  return isqrt_nearest(xx + yy);  // at most 2^63
}

}  // namespace berth
