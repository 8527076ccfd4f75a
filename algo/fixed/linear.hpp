// Symmetric positive definite systems (normal equations) and the eigenvectors of a 3 x 3 matrix.
//
//   A x = b,  A' = S A S = L L^T,  S = diag(2^-e_i): the diagonal of A' lies in [1/4, 1)
//
// Cholesky's factor rather than L D L^T because |L| <= 1 whatever the condition, which is what a
// fixed-point number wants: L has 60 fraction bits. Jacobi scaling by powers of two is exact and
// within a factor of 4 of the best condition that any diagonal scaling gives (van der Sluis 1969).
// Solutions and the inverse carry a shared exponent per column, so no right-hand side can overflow.
//
// Relative error (norm, in scaled units): below 2^-54 cond(A'); measured in docs/fixed_point.md.
#pragma once

#include <cstdint>

#include "fixed/eigen.hpp"
#include "fixed/q.hpp"

namespace berth {

constexpr int kMaxUnknowns = 10;

/// The solver proper, for any size up to kMaxUnknowns; matrices are row-major, n by n.
class SpdSolver {
 public:
  /// Factors `matrix` (|a_ij| < 2^62, any common scale; the lower triangle is read). False, and
  /// nothing to solve with, when a pivot of A' is not above 2^-40, that is when the matrix is not
  /// positive definite within about twelve decimal digits. Cost for n = 6: about 6000
  /// instructions.
  bool factor(int n, const std::int64_t* matrix);

  /// x = A^-1 b with `fraction_bits` bits: x[i] = round(2^fraction_bits x_i). |b| < 2^62. False,
  /// and x untouched, when an element would reach 2^62. b and x may be the same. Cost for n = 6:
  /// about 4500.
  bool solve(const std::int64_t* b, std::int64_t* x, int fraction_bits) const;

  /// Computes A^-1 for the queries below; call after factor(). Cost for n = 6: about 16 000.
  void invert();

  /// sqrt((A^-1)_ii) of a matrix whose integers carry `matrix_fraction_bits`, with
  /// `fraction_bits` bits; clamped to 2^62. Relative error 2^-30 and the matrix's own.
  std::int64_t sigma(int i, int matrix_fraction_bits, int fraction_bits) const;

  /// (A^-1)_ij / sqrt((A^-1)_ii (A^-1)_jj), in [-1, 1].
  Unit correlation(int i, int j) const;

  /// (A^-1)_ij as mantissa 2^exponent, of the matrix as integers. |mantissa| < 2^60.
  std::int64_t inverse_mantissa(int i, int j) const { return inverse_[i * n_ + j]; }
  int inverse_exponent(int i, int j) const { return inverse_exponent_[i] + inverse_exponent_[j]; }

 private:
  struct Block {
    std::int64_t mantissa[kMaxUnknowns];
    int exponent = 0;  // shared
  };
  struct Inverse {
    std::int64_t half;
    int left;
  };
  static std::int64_t root_of(std::int64_t d, Inverse& inverse);
  static std::int64_t over(std::int64_t value, const Inverse& l);
  std::int64_t factor_at(int row, int column) const { return factor_[row * n_ + column]; }
  void keep_headroom(Block& block, std::int64_t& sum, std::int64_t divisor) const;
  void substitute_forward(Block& block, int first) const;
  void substitute_backward(Block& block) const;

  // Written by factor() and invert() before they are read: zeros first would cost 600 instructions.
  int n_ = 0;
  int scale_[kMaxUnknowns];                           // e_i
  std::int64_t factor_[kMaxUnknowns * kMaxUnknowns];  // L, 60 fraction bits
  Inverse inverse_diagonal_[kMaxUnknowns];            // of L
  std::int64_t inverse_[kMaxUnknowns * kMaxUnknowns];
  int inverse_exponent_[kMaxUnknowns];
};

/// The same with the size in the type. 1.9 KiB whatever N is: one at a time on the stack.
template <int N>
class SpdSystem {
  static_assert(N >= 1 && N <= kMaxUnknowns);

 public:
  using Matrix = std::int64_t[N][N];
  using Vector = std::int64_t[N];

  bool factor(const Matrix& matrix) { return solver_.factor(N, &matrix[0][0]); }
  bool solve(const Vector& b, Vector& x, int fraction_bits) const {
    return solver_.solve(b, x, fraction_bits);
  }
  void invert() { solver_.invert(); }
  std::int64_t sigma(int i, int matrix_fraction_bits, int fraction_bits) const {
    return solver_.sigma(i, matrix_fraction_bits, fraction_bits);
  }
  Unit correlation(int i, int j) const { return solver_.correlation(i, j); }
  std::int64_t inverse_mantissa(int i, int j) const { return solver_.inverse_mantissa(i, j); }
  int inverse_exponent(int i, int j) const { return solver_.inverse_exponent(i, j); }

 private:
  SpdSolver solver_;
};

/// A = V diag(values) V^T, V a rotation (det = 1), values descending.
struct SymmetricEigen3 {
  Unit values[3];
  Eigen::Matrix<Unit, 3, 3> vectors;  // columns
};

/// Eigen-decomposition of a symmetric matrix with |entries| <= 1 and spectral norm below 2, by five
/// sweeps of Jacobi's cyclic method (Golub, Van Loan, 8.5) with 58 fraction bits; the upper
/// triangle is read. Error of the values below 2^-29, of the vectors below 2^-29 / gap, where gap
/// is the distance to the next eigenvalue. Cost: about 22 000 instructions.
SymmetricEigen3 decompose_symmetric(const Eigen::Matrix<Unit, 3, 3>& matrix);

}  // namespace berth
