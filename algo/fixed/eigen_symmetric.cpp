// Jacobi's cyclic method for symmetric 3 x 3 matrices; see linear.hpp.
#include "fixed/linear.hpp"
#include "fixed/roots.hpp"
#include "fixed/wide.hpp"

namespace berth {
namespace {

constexpr int kFraction = 58;
constexpr std::int64_t kOne = std::int64_t{1} << kFraction;
constexpr int kSweeps = 5;

using Wide3 = std::int64_t[3][3];

struct Rotation {
  std::int64_t cos = kOne, sin = 0;
};

// Angle that annihilates a_pq: t = tan = 2 a_pq / (d +- hypot(d, 2 a_pq)), d = a_qq - a_pp,
// |t| <= 1. t is good to 2^-29; cos and sin are those of this t to 2^-57, so that V stays a
// rotation and the next sweep removes what is left.
Rotation annihilating_rotation(std::int64_t app, std::int64_t aqq, std::int64_t apq) {
  if (apq == 0) return {};
  const std::int64_t pair[2] = {aqq - app, 2 * apq};
  const int shift = block_shift(pair, 2, 30);
  const auto d = narrow<std::int32_t>(scale_by_power(pair[0], shift));
  const auto o = narrow<std::int32_t>(scale_by_power(pair[1], shift));
  const std::int64_t length = hypot(d, o);
  const std::int64_t denominator = d >= 0 ? d + length : d - length;
  const std::int64_t t = div_shift(o, 30, denominator);  // 30 fraction bits
  if (t == 0) return {};                                 // what follows gives the same
  // cos = 1 / sqrt(1 + t^2): 1 + t^2 is exact with 60 fraction bits; root by isqrt and Newton.
  const std::int64_t square = (std::int64_t{1} << 60) + t * t;
  const std::int64_t r = std::int64_t{isqrt(static_cast<std::uint64_t>(square) << 2)} << 29;
  const std::int64_t root = shift_round(r + div_shift(square, 60, r), 1);
  const std::int64_t cos = div_shift(kOne, 60, root);
  return {cos, mul_shift(cos, t, 30)};
}

// a b with 58 fraction bits, to 2^-55: the product of the lower halves is left out.
inline std::int64_t multiply(std::int64_t a, std::int64_t b) {
  const auto a1 = static_cast<std::int32_t>(a >> 32), b1 = static_cast<std::int32_t>(b >> 32);
  const std::int64_t a0 = static_cast<std::uint32_t>(a), b0 = static_cast<std::uint32_t>(b);
  // |a|, |b| < 2^60: every part is below 2^62.
  return std::int64_t{a1} * b1 * 64 + ((a1 * b0) >> 26) + ((b1 * a0) >> 26);
}

// Columns p and q of m become cos p - sin q and sin p + cos q.
void rotate_columns(Wide3& m, int p, int q, const Rotation& r) {
  for (int i = 0; i < 3; ++i) {
    const std::int64_t a = m[i][p], b = m[i][q];
    m[i][p] = multiply(r.cos, a) - multiply(r.sin, b);
    m[i][q] = multiply(r.sin, a) + multiply(r.cos, b);
  }
}

void rotate_rows(Wide3& m, int p, int q, const Rotation& r) {
  for (int i = 0; i < 3; ++i) {
    const std::int64_t a = m[p][i], b = m[q][i];
    m[p][i] = multiply(r.cos, a) - multiply(r.sin, b);
    m[q][i] = multiply(r.sin, a) + multiply(r.cos, b);
  }
}

void swap_columns(Wide3& v, int p, int q) {
  for (int i = 0; i < 3; ++i) {
    const std::int64_t keep = v[i][p];
    v[i][p] = -v[i][q];  // the sign keeps det = 1
    v[i][q] = keep;
  }
}

// Descending eigenvalues on the diagonal of a, columns of v along with them.
void sort_descending(Wide3& a, Wide3& v) {
  constexpr int kPairs[3][2] = {{0, 1}, {1, 2}, {0, 1}};
  for (const auto& pair : kPairs) {
    const int p = pair[0], q = pair[1];
    if (a[p][p] >= a[q][q]) continue;
    const std::int64_t keep = a[p][p];
    a[p][p] = a[q][q];
    a[q][q] = keep;
    swap_columns(v, p, q);
  }
}

}  // namespace

SymmetricEigen3 decompose_symmetric(const Eigen::Matrix<Unit, 3, 3>& matrix) {
  Wide3 a, v;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const std::int32_t raw = (i < j ? matrix(i, j) : matrix(j, i)).raw();
      a[i][j] = std::int64_t{raw} * (std::int64_t{1} << (kFraction - 30));
      v[i][j] = i == j ? kOne : 0;
    }
  }
  constexpr int kPairs[3][2] = {{0, 1}, {0, 2}, {1, 2}};
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (const auto& pair : kPairs) {
      const int p = pair[0], q = pair[1];
      const Rotation r = annihilating_rotation(a[p][p], a[q][q], a[p][q]);
      if (r.sin == 0) continue;  // no rotation: every product below is exact
      rotate_columns(a, p, q, r);
      rotate_rows(a, p, q, r);
      rotate_columns(v, p, q, r);
    }
  }
  sort_descending(a, v);
  SymmetricEigen3 result;
  for (int i = 0; i < 3; ++i) {
    result.values[i] = Unit::saturated(shift_round(a[i][i], kFraction - 30));
    for (int j = 0; j < 3; ++j) {
      result.vectors(i, j) = Unit::from_wide(shift_round(v[i][j], kFraction - 30));
    }
  }
  return result;
}

}  // namespace berth
