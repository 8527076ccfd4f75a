// See roots.hpp.
#include "fixed/roots.hpp"

namespace berth {
namespace {

struct Root {
  std::uint32_t root, rest;  // value - root^2
};

// floor(sqrt(value)), value >= 2^30: a straight line within 4.5 % of it, then two of Heron's steps,
// to 0.1 % and 2^-20. They round down to the root or one above.
inline Root root32(std::uint32_t value) {
  std::uint32_t root = (value >> 17) + (value >> 19) + 23921;
  root = (root + value / root) >> 1;
  root = (root + value / root) >> 1;
  const std::uint32_t rest = value - root * root;
  if (static_cast<std::int32_t>(rest) >= 0) return {root, rest};
  return {root - 1, rest + 2 * root - 1};
}

// floor(sqrt(value)), value >= 2^62: upper half by root32, lower half by division.
inline std::uint32_t root64(std::uint64_t value) {
  const Root upper = root32(static_cast<std::uint32_t>(value >> 32));
  const std::uint32_t next = static_cast<std::uint32_t>(value) >> 17;
  std::uint32_t lower = ((upper.rest << 15) + next) / upper.root;  // rest <= 2 root < 2^17
  if (lower > 0xffff) lower = 0xffff;
  const std::uint32_t root = (upper.root << 16) + lower;
  return std::uint64_t{root} * root > value ? root - 1 : root;
}

}  // namespace

std::uint32_t isqrt(std::uint64_t value) {
  const auto high = static_cast<std::uint32_t>(value >> 32);
  if (high != 0) {
    const int shift = leading_zeros32(high) & ~1;
    return root64(value << shift) >> (shift / 2);
  }
  const auto low = static_cast<std::uint32_t>(value);
  if (low == 0) return 0;
  const int shift = leading_zeros32(low) & ~1;
  return root32(low << shift).root >> (shift / 2);
}

std::uint32_t root_q16(std::uint32_t value) {
  BERTH_RANGE(value != 0);
  const int shift = leading_zeros32(value) & ~1;
  const Root upper = root32(value << shift);
  std::uint32_t lower = (upper.rest << 15) / upper.root;  // rest <= 2 root < 2^17
  if (lower > 0xffff) lower = 0xffff;
  return ((upper.root << 16) + lower) >> (shift / 2);
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
