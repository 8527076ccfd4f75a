// See linear.hpp.
#include "fixed/linear.hpp"

#include "fixed/roots.hpp"
#include "fixed/wide.hpp"

namespace berth {
namespace {

constexpr int kFraction = 60;  // of A' and L
constexpr std::int64_t kOne = std::int64_t{1} << kFraction;
constexpr std::int64_t kMinPivot = std::int64_t{1} << 20;  // 2^-40
constexpr int kBlockBits = 57;                             // of a fresh right-hand side

// Entry of A' with 60 fraction bits; false where |a_ij| exceeds what the diagonal allows.
bool scale_entry(std::int64_t value, int exponent, std::int64_t& out) {
  const int shift = kFraction - exponent;
  if (bit_length(value) + shift > kFraction) return false;
  out = scale_by_power(value, shift);
  return true;
}

}  // namespace

// l = sqrt(d) and its inverse, 2^-40 < d < 1: n = d 4^(left + 1) in [1, 4), y = 1 / sqrt(n) to 30
// bits and by a Newton step y + y (1 - n y^2) / 2 to 2^-57; sqrt(n) = n y.
std::int64_t SpdSolver::root_of(std::int64_t d, Inverse& inverse) {
  if (d >= kOne) d = kOne - 1;                                 // by the rounding of the scale
  const int shift = (leading_zeros64(magnitude(d)) - 2) & ~1;  // d 2^shift in [2^60, 2^62)
  const std::int64_t quarter = (d << (shift - 2));             // of n
  const std::uint32_t root = isqrt(static_cast<std::uint64_t>(quarter) << 4);  // Q<31>, >= 2^31
  const std::int64_t y = std::int64_t{reciprocal(root).mantissa} << 29;
  const std::int64_t error = kOne - 4 * multiply_60(multiply_60(quarter, y), y);  // below 2^-28
  inverse = {y + multiply_60(y, error) / 2, shift / 2 - 1};
  if (inverse.half > kOne) inverse.half = kOne;
  return shift_by(multiply_60(quarter, inverse.half), 2 - shift / 2);
}

// value / l where that is within 1, to 2^-60 and as much of itself.
std::int64_t SpdSolver::over(std::int64_t value, const Inverse& l) {
  return multiply_60(shift_by(value, l.left), l.half) * 2;
}

bool SpdSolver::factor(int n, const std::int64_t* matrix) {
  BERTH_RANGE(n >= 1 && n <= kMaxUnknowns);
  n_ = n;
  for (int i = 0; i < n; ++i) {
    const std::int64_t diagonal = matrix[i * n + i];
    if (diagonal <= 0) return false;
    scale_[i] = (bit_length(diagonal) + 1) / 2;  // a_ii 2^(-2 e) in [1/4, 1)
  }
  for (int j = 0; j < n; ++j) {
    for (int i = j; i < n; ++i) {
      std::int64_t sum = 0;
      if (!scale_entry(matrix[i * n + j], scale_[i] + scale_[j], sum)) return false;
      for (int k = 0; k < j; ++k) sum -= multiply_60(factor_at(i, k), factor_at(j, k));
      if (i == j) {
        if (sum <= kMinPivot) return false;
        factor_[j * n + j] = root_of(sum, inverse_diagonal_[j]);
      } else {
        // |L_ij| <= sqrt(a'_ii) < 1 or the matrix is not positive definite.
        if (magnitude(sum) >= magnitude(factor_at(j, j))) return false;
        factor_[i * n + j] = over(sum, inverse_diagonal_[j]);
      }
    }
  }
  return true;
}

// Shifts the block and the sum right until sum / divisor fits one bit more than a fresh block.
void SpdSolver::keep_headroom(Block& block, std::int64_t& sum, std::int64_t divisor) const {
  const int bits = bit_length(sum) + kFraction + 1 - bit_length(divisor);
  const int excess = bits - (kBlockBits + 1);
  if (excess <= 0) return;
  for (int i = 0; i < n_; ++i) block.mantissa[i] = scale_by_power(block.mantissa[i], -excess);
  sum = scale_by_power(sum, -excess);
  block.exponent += excess;
}

// L y = b in place; rows before `first` are zero. |mantissa| <= 2^58, so |sum| < 11 2^58 < 2^62.
void SpdSolver::substitute_forward(Block& block, int first) const {
  for (int i = first; i < n_; ++i) {
    std::int64_t sum = block.mantissa[i];
    for (int k = first; k < i; ++k) {
      sum -= multiply_60(factor_at(i, k), block.mantissa[k]);
    }
    keep_headroom(block, sum, factor_at(i, i));
    block.mantissa[i] = over(sum, inverse_diagonal_[i]);
  }
}

// L^T x = y in place.
void SpdSolver::substitute_backward(Block& block) const {
  for (int i = n_ - 1; i >= 0; --i) {
    std::int64_t sum = block.mantissa[i];
    for (int k = i + 1; k < n_; ++k) {
      sum -= multiply_60(factor_at(k, i), block.mantissa[k]);
    }
    keep_headroom(block, sum, factor_at(i, i));
    block.mantissa[i] = over(sum, inverse_diagonal_[i]);
  }
}

bool SpdSolver::solve(const std::int64_t* b, std::int64_t* x, int fraction_bits) const {
  // S b as a block: the largest element gets kBlockBits bits.
  int longest = -100;
  for (int i = 0; i < n_; ++i) {
    const int length = bit_length(b[i]) - scale_[i];
    if (b[i] != 0 && length > longest) longest = length;
  }
  Block block;
  block.exponent = longest - kBlockBits;
  for (int i = 0; i < n_; ++i) {
    block.mantissa[i] = b[i] == 0 ? 0 : scale_by_power(b[i], -scale_[i] - block.exponent);
  }
  substitute_forward(block, 0);
  substitute_backward(block);
  for (int i = 0; i < n_; ++i) {
    const int shift = block.exponent - scale_[i] + fraction_bits;
    if (block.mantissa[i] != 0 && bit_length(block.mantissa[i]) + shift > 62) return false;
  }
  for (int i = 0; i < n_; ++i) {
    x[i] = scale_by_power(block.mantissa[i], block.exponent - scale_[i] + fraction_bits);
  }
  return true;
}

// A^-1 = S W^T W S with W = L^-1, whose columns are blocks of their own.
void SpdSolver::invert() {
  Block columns[kMaxUnknowns];
  for (int j = 0; j < n_; ++j) {
    Block& w = columns[j];
    for (int i = 0; i < n_; ++i) w.mantissa[i] = 0;
    w.mantissa[j] = std::int64_t{1} << (kBlockBits - 1);
    w.exponent = 1 - kBlockBits;
    substitute_forward(w, j);
    // Products below are shifted right by 60, split evenly between both columns.
    inverse_exponent_[j] = w.exponent + kFraction / 2 - scale_[j];
  }
  for (int i = 0; i < n_; ++i) {
    for (int j = 0; j <= i; ++j) {
      std::int64_t sum = 0;  // at most 10 2^(58 + 58 - 60) < 2^60
      for (int k = i; k < n_; ++k) {
        sum += multiply_60(columns[i].mantissa[k], columns[j].mantissa[k]);
      }
      inverse_[i * n_ + j] = sum;
      inverse_[j * n_ + i] = sum;
    }
  }
}

std::int64_t SpdSolver::sigma(int i, int matrix_fraction_bits, int fraction_bits) const {
  // variance = mantissa 2^(2 exponent + matrix_fraction_bits); an odd bit goes into the mantissa.
  const int odd = matrix_fraction_bits & 1;
  const auto mantissa = static_cast<std::uint64_t>(inverse_[i * n_ + i]) << odd;
  const int spare = leading_zeros64(mantissa) & ~1;
  const std::uint32_t root = isqrt_nearest(mantissa << spare);
  const int shift =
      inverse_exponent_[i] + (matrix_fraction_bits - odd) / 2 - spare / 2 + fraction_bits;
  constexpr std::int64_t kLargest = std::int64_t{1} << 62;
  return bit_length(root) + shift > 62 ? kLargest : scale_by_power(root, shift);
}

Unit SpdSolver::correlation(int i, int j) const {
  if (i == j) return Unit(1);
  const std::uint64_t root_i = isqrt_nearest(static_cast<std::uint64_t>(inverse_[i * n_ + i]) << 4);
  const std::uint64_t root_j = isqrt_nearest(static_cast<std::uint64_t>(inverse_[j * n_ + j]) << 4);
  const auto half_product = static_cast<std::int64_t>((root_i * root_j) >> 1);  // 8 sigma sigma
  const std::int64_t r = div_shift(inverse_[i * n_ + j], 33, half_product);
  constexpr std::int64_t kUnit = std::int64_t{1} << 30;
  return Unit::from_wide(r > kUnit ? kUnit : (r < -kUnit ? -kUnit : r));
}

}  // namespace berth
