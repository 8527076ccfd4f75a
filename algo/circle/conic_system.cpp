#include "circle/conic_system.hpp"

#include "fixed/roots.hpp"
#include "image/packed.hpp"

namespace berth {
namespace {

constexpr int kFactorBits = 30;
constexpr int kSolutionBits = 24;
constexpr int kSumBits = kFactorBits + kSolutionBits;
constexpr std::int64_t kMinPivot = std::int64_t{1} << (2 * kFactorBits - 20);
constexpr std::int64_t kSolutionLimit = std::int64_t{32} << kSolutionBits;

constexpr int entry(int row, int column) { return row * (row + 1) / 2 + column; }

// Cholesky's factor of the scaled matrix.
class Factor {
 public:
  bool compute(const std::int64_t* gram) {
    for (int i = 0; i < kConicTerms; ++i) {
      const std::int64_t diagonal = gram[entry(i, i)];
      if (diagonal <= 0) return false;
      scale_[i] = (bit_length(diagonal) + 1) / 2;  // gram_ii 2^(-2 scale) in [1/4, 1)
      if (scale_[i] > largest_) largest_ = scale_[i];
    }
    for (int j = 0; j < kConicTerms; ++j) {
      for (int i = j; i < kConicTerms; ++i) {
        // |gram_ij| <= 2^(scale_i + scale_j), scales of at most 22: the shift is exact.
        std::int64_t sum =
            gram[entry(i, j)] * (std::int64_t{1} << (2 * kFactorBits - scale_[i] - scale_[j]));
        for (int k = 0; k < j; ++k) sum -= std::int64_t{at(i, k)} * at(j, k);
        if (i > j) {
          factor_[entry(i, j)] = static_cast<std::int32_t>(quotient(sum, j));
        } else {
          if (sum < kMinPivot) return false;
          const std::uint32_t root = isqrt(static_cast<std::uint64_t>(sum));
          factor_[entry(j, j)] = static_cast<std::int32_t>(root);
          inverse_[j] = reciprocal(root);
        }
      }
    }
    return true;
  }

  // The right-hand side sums_i 2^-(scale_i + largest): then the solution is k_i 2^(scale_i -
  // largest), no larger than k. `y` is solved for in place, false where it reaches the limit.
  bool solve(const std::int32_t* sums, std::int64_t (&y)[kConicTerms]) const {
    for (int i = 0; i < kConicTerms; ++i) {
      const int shift = kSumBits + 12 - scale_[i] - largest_;
      if (bit_length(sums[i]) + shift > 60) return false;
      std::int64_t sum = std::int64_t{sums[i]} * (std::int64_t{1} << shift);
      for (int k = 0; k < i; ++k) sum -= at(i, k) * y[k];
      if (!divide(sum, i, y[i])) return false;
    }
    for (int i = kConicTerms - 1; i >= 0; --i) {
      std::int64_t sum = y[i] * (std::int64_t{1} << kFactorBits);
      for (int k = i + 1; k < kConicTerms; ++k) sum -= at(k, i) * y[k];
      if (!divide(sum, i, y[i])) return false;
    }
    for (int i = 0; i < kConicTerms; ++i) {
      const int shift = largest_ - scale_[i];
      if (bit_length(y[i]) + shift > kSolutionBits + 5) return false;
      y[i] *= std::int64_t{1} << shift;
    }
    return true;
  }

 private:
  std::int32_t at(int row, int column) const { return factor_[entry(row, column)]; }

  // sum / factor_jj; |sum| < 2^60 + 2^31.
  std::int64_t quotient(std::int64_t sum, int j) const {
    return multiply_reciprocal(static_cast<std::int32_t>(shift_round(sum, kFactorBits)),
                               inverse_[j], kFactorBits);
  }

  bool divide(std::int64_t sum, int i, std::int64_t& y) const {
    if (bit_length(sum) > 60) return false;
    y = quotient(sum, i);
    return y < kSolutionLimit && y > -kSolutionLimit;
  }

  std::int32_t factor_[kConicTerms * (kConicTerms + 1) / 2];
  Reciprocal inverse_[kConicTerms];
  int scale_[kConicTerms];
  int largest_ = 0;
};

}  // namespace

// All terms are below 4 in size: with 12 fraction bits they fit 16 bits, 65535 of them 32.
void ConicSystem::add_two(const Point& p, const Point& q) {
  const auto both_of = [](std::int32_t of_p, std::int32_t of_q) {
    return first_and_second(static_cast<Pair>(of_p), static_cast<Pair>(of_q) << 16);
  };
  const Pair xx = both_of((p.x * p.x) >> 12, (q.x * q.x) >> 12);
  const Pair xy = both_of((p.x * p.y) >> 12, (q.x * q.y) >> 12);
  const Pair yy = both_of((p.y * p.y) >> 12, (q.y * q.y) >> 12);
  const Pair x = both_of(p.x, q.x), y = both_of(p.y, q.y);
  std::int64_t* g = gram_;
  const auto put = [&g](Pair a, Pair b) {
    *g = add_products_wide(a, b, *g);
    ++g;
  };
  put(xx, xx);
  put(xy, xx), put(xy, xy);
  put(yy, xx), put(yy, xy), put(yy, yy);
  put(x, xx), put(x, xy), put(x, yy), put(x, x);
  put(y, xx), put(y, xy), put(y, yy), put(y, x), put(y, y);
  const auto sum = [](std::int32_t& to, Pair a) { to = add_products(a, both(1), to); };
  sum(sums_[0], xx);
  sum(sums_[1], xy);
  sum(sums_[2], yy);
  sum(sums_[3], x);
  sum(sums_[4], y);
}

bool ConicSystem::solve(std::int32_t (&k)[kConicTerms]) {
  if (count_ % 2 != 0) add_two(waiting_, {0, 0});  // which adds nothing
  waiting_ = {};
  Factor factor;
  std::int64_t y[kConicTerms];
  if (!factor.compute(gram_) || !factor.solve(sums_, y)) return false;
  for (int i = 0; i < kConicTerms; ++i) k[i] = narrow<std::int32_t>(y[i]);
  return true;
}

}  // namespace berth
