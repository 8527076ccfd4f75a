// See vector.hpp.
#include "fixed/vector.hpp"

#include "fixed/wide.hpp"

namespace berth {

bool normalize_raw(const std::int32_t (&v)[3], Unit (&unit)[3]) {
  const std::int64_t wide[3] = {v[0], v[1], v[2]};
  // 30 bits for the largest element: the sum of squares is below 3 2^60.
  const int shift = block_shift(wide, 3, 30);
  std::int32_t scaled[3];
  std::uint64_t sum = 0;
  for (int i = 0; i < 3; ++i) {
    scaled[i] = narrow<std::int32_t>(scale_by_power(wide[i], shift));
    sum += static_cast<std::uint64_t>(std::int64_t{scaled[i]} * scaled[i]);
  }
  if (sum == 0) return false;
  const Reciprocal r = reciprocal(isqrt_nearest(sum << 2));  // of twice the length
  for (int i = 0; i < 3; ++i) {
    unit[i] = Unit::from_wide(multiply_reciprocal(scaled[i], r, 31));
  }
  return true;
}

}  // namespace berth
