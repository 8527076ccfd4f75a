// The normal equations of a conic fit, five unknowns, solved in 32-bit arithmetic.
//
//   sum v v^T k = sum v,  v = (x^2, x y, y^2, x, y),  A x^2 + B x y + C y^2 + D x + E y = 1
//
// Scaled by powers of two so that the diagonal lies in [1/4, 1), then Cholesky's factor with 30
// fraction bits: products are summed exactly in 64 bits, so that only the factor's own rounding
// remains, 2^-30 of the matrix. That is a thousandth of the smallest pivot accepted.
#pragma once

#include <cstdint>

#include "core/check.hpp"

namespace berth {

constexpr int kConicTerms = 5;

class ConicSystem {
 public:
  /// A point of the fit, 12 fraction bits, |x|, |y| < 2; at most 65535 points. Cost: about 55.
  void add(std::int32_t x, std::int32_t y) {
    BERTH_RANGE(x > -8192 && x < 8192 && y > -8192 && y < 8192 && count_ < 65535);
    const Point p = {x, y};
    if (++count_ % 2 != 0) {
      waiting_ = p;
    } else {
      add_two(waiting_, p);
    }
  }
  int count() const { return count_; }

  /// k with 24 fraction bits. False when the points do not determine a conic (a pivot below 2^-20)
  /// or |k_i| reaches 32. Cost: about 2000 instructions.
  bool solve(std::int32_t (&k)[kConicTerms]);

 private:
  struct Point {
    std::int32_t x, y;
  };
  void add_two(const Point& p, const Point& q);

  std::int64_t gram_[kConicTerms * (kConicTerms + 1) / 2] = {};  // lower triangle, 24 fraction bits
  std::int32_t sums_[kConicTerms] = {};                          // 12 fraction bits
  int count_ = 0;
  Point waiting_{};  // for the second one: points are added two at a time
};

}  // namespace berth
