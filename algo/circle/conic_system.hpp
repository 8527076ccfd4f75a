// The normal equations of a conic fit, five unknowns, solved in 32-bit arithmetic.
//
//   sum v v^T k = sum v,  v = (x^2, x y, y^2, x, y),  A x^2 + B x y + C y^2 + D x + E y = 1
//
// Scaled by powers of two so that the diagonal lies in [1/4, 1), then Cholesky's factor with 30
// fraction bits: products are summed exactly in 64 bits, so that only the factor's own rounding
// remains, 2^-30 of the matrix. That is a thousandth of the smallest pivot accepted.
#pragma once

#include <cstdint>

namespace berth {

constexpr int kConicTerms = 5;

class ConicSystem {
 public:
  /// A point of the fit, 12 fraction bits, |x|, |y| < 2; at most 65535 points. Cost: about 75.
  void add(std::int32_t x, std::int32_t y);
  int count() const { return count_; }

  /// k with 24 fraction bits. False when the points do not determine a conic (a pivot below 2^-20)
  /// or |k_i| reaches 32. Cost: about 2000 instructions.
  bool solve(std::int32_t (&k)[kConicTerms]) const;

 private:
  std::int64_t gram_[kConicTerms * (kConicTerms + 1) / 2] = {};  // lower triangle, 24 fraction bits
  std::int64_t sums_[kConicTerms] = {};                          // 12 fraction bits
  int count_ = 0;
};

}  // namespace berth
