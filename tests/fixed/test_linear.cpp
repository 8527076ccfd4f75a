// The SPD solver against long double over conditions up to 1e12, and the 3 x 3 eigenvectors.
#include <gtest/gtest.h>

#include <algorithm>

#include "camera/camera.hpp"
#include "fixed/linear.hpp"
#include "reference.hpp"
// After fixed/eigen.hpp, which sets Eigen up.
#include <Eigen/Dense>

namespace berth_test {
namespace {

constexpr int kN = 6;
using Real = long double;
using Matrix6 = Eigen::Matrix<Real, kN, kN>;
using Vector6 = Eigen::Matrix<Real, kN, 1>;

// A random SPD matrix of 50 bits with the given condition, then scaled row by row.
struct Problem {
  std::int64_t a[kN][kN], b[kN];
  Matrix6 matrix;
  Vector6 rhs;
};

Problem random_problem(Random& random, double condition, int scale_bits) {
  Matrix6 m;
  for (int i = 0; i < kN * kN; ++i) m.data()[i] = random.uniform(-1, 1);
  const Matrix6 q = Eigen::HouseholderQR<Matrix6>(m).householderQ();
  Vector6 values, scales;
  for (int i = 0; i < kN; ++i) {
    values[i] = std::pow(condition, -static_cast<double>(i) / (kN - 1));
    scales[i] = std::exp2(-static_cast<double>(random.bits() % (scale_bits + 1)));
  }
  const Matrix6 a =
      scales.asDiagonal() * q * values.asDiagonal() * q.transpose() * scales.asDiagonal();
  Problem p;
  for (int i = 0; i < kN; ++i) {
    for (int j = 0; j <= i; ++j) {
      p.a[i][j] = p.a[j][i] = std::llround(a(i, j) * 0x1p60L);
      p.matrix(i, j) = p.matrix(j, i) = static_cast<Real>(p.a[i][j]);
    }
    p.b[i] = static_cast<std::int64_t>(random.bits()) >> 14;
    p.rhs[i] = static_cast<Real>(p.b[i]);
  }
  return p;
}

// Condition after the diagonal is scaled to one: what the stated error refers to.
double scaled_condition(const Matrix6& a) {
  const Vector6 s = a.diagonal().cwiseSqrt().cwiseInverse();
  const Vector6 e =
      Eigen::SelfAdjointEigenSolver<Matrix6>(s.asDiagonal() * a * s.asDiagonal()).eigenvalues();
  return static_cast<double>(e[kN - 1] / e[0]);
}

// |x - expected| in scaled units (each unknown over its column's scale), relative.
double relative_error(const Problem& p, const Vector6& x, const Vector6& expected) {
  const Vector6 scale = p.matrix.diagonal().cwiseSqrt();
  return static_cast<double>((x - expected).cwiseProduct(scale).norm() /
                             expected.cwiseProduct(scale).norm());
}

// Solves with as many fraction bits as fit.
bool solve_scaled(const berth::SpdSystem<kN>& system, const Problem& p, Vector6& x) {
  for (int bits = 100; bits > -20; --bits) {
    std::int64_t raw[kN];
    if (!system.solve(p.b, raw, bits)) continue;
    for (int i = 0; i < kN; ++i) x[i] = std::ldexp(static_cast<Real>(raw[i]), -bits);
    return true;
  }
  return false;
}

class SpdCondition : public testing::TestWithParam<double> {};

TEST_P(SpdCondition, SolutionAndCovarianceAreWithinTheStatedError) {
  Random random;
  double worst = 0, worst_sigma = 0, worst_correlation = 0;
  for (int n = 0; n < 400; ++n) {
    const Problem p = random_problem(random, GetParam(), 0);
    berth::SpdSystem<kN> system;
    ASSERT_TRUE(system.factor(p.a));
    Vector6 x;
    ASSERT_TRUE(solve_scaled(system, p, x));
    const Vector6 expected = p.matrix.ldlt().solve(p.rhs);
    worst = std::max(worst, relative_error(p, x, expected) / scaled_condition(p.matrix));
    system.invert();
    const Matrix6 inverse = p.matrix.inverse();
    for (int i = 0; i < kN; ++i) {
      const Real sigma = std::sqrt(inverse(i, i)) * 0x1p30L;  // matrix of 60 fraction bits
      const Real measured = std::ldexp(static_cast<Real>(system.sigma(i, 60, 40)), -40);
      worst_sigma = std::max(worst_sigma, static_cast<double>(std::abs(measured / sigma - 1)));
      for (int j = 0; j < kN; ++j) {
        const Real correlation = inverse(i, j) / std::sqrt(inverse(i, i) * inverse(j, j));
        const double error = real(system.correlation(i, j)) - static_cast<double>(correlation);
        worst_correlation = std::max(worst_correlation, std::abs(error));
        const Real element = std::ldexp(static_cast<Real>(system.inverse_mantissa(i, j)),
                                        system.inverse_exponent(i, j));
        EXPECT_LE(std::abs(element - inverse(i, j)),
                  1e-6L * std::sqrt(inverse(i, i) * inverse(j, j)));
      }
    }
  }
  RecordProperty("log2_worst_over_condition", std::to_string(std::log2(worst)));
  EXPECT_LE(worst, 0x1p-54);
  EXPECT_LE(worst_sigma, 0x1p-29 + GetParam() * 0x1p-52);
  EXPECT_LE(worst_correlation, 0x1p-28 + GetParam() * 0x1p-52);
}

INSTANTIATE_TEST_SUITE_P(Conditions, SpdCondition, testing::Values(1e1, 1e2, 1e3, 1e4, 1e6, 1e8));

TEST(SpdSystem, ColumnsOfVeryDifferentScale) {
  Random random;
  for (int n = 0; n < 300; ++n) {
    const Problem p = random_problem(random, 1e3, 12);  // diagonal over 2^24
    berth::SpdSystem<kN> system;
    ASSERT_TRUE(system.factor(p.a));
    Vector6 x;
    ASSERT_TRUE(solve_scaled(system, p, x));
    EXPECT_LE(relative_error(p, x, p.matrix.ldlt().solve(p.rhs)), 1e-11);
  }
}

TEST(SpdSystem, RefusesWhatIsNotPositiveDefinite) {
  berth::SpdSystem<2> system;
  EXPECT_FALSE(system.factor({{1, 0}, {0, 0}}));
  EXPECT_FALSE(system.factor({{1, 0}, {0, -1}}));
  EXPECT_FALSE(system.factor({{4, 6}, {6, 9}}));  // singular
  EXPECT_FALSE(system.factor({{4, 7}, {7, 9}}));  // indefinite
  EXPECT_FALSE(system.factor({{1, std::int64_t{1} << 61}, {std::int64_t{1} << 61, 1}}));
  EXPECT_TRUE(system.factor({{4, 5}, {5, 9}}));
  Random random;
  for (int n = 0; n < 200; ++n) {
    Problem p = random_problem(random, 1e3, 0);
    p.a[4][4] = -p.a[4][4];
    berth::SpdSystem<kN> six;
    EXPECT_FALSE(six.factor(p.a));
  }
}

TEST(SpdSystem, ExtremesOfRangeAndSize) {
  berth::SpdSystem<1> one;
  std::int64_t x[1] = {7};
  ASSERT_TRUE(one.factor({{(std::int64_t{1} << 62) - 1}}));
  ASSERT_TRUE(one.solve({(std::int64_t{1} << 62) - 1}, x, 30));
  EXPECT_EQ(x[0], 1 << 30);
  ASSERT_TRUE(one.factor({{1}}));
  EXPECT_FALSE(one.solve({std::int64_t{1} << 61}, x, 30));
  EXPECT_EQ(x[0], 1 << 30);  // untouched
  EXPECT_TRUE(one.solve({0}, x, 60));
  EXPECT_EQ(x[0], 0);

  berth::SpdSystem<10> ten;
  std::int64_t a[10][10] = {}, b[10], y[10];
  for (int i = 0; i < 10; ++i) {
    for (int j = 0; j < 10; ++j) a[i][j] = i == j ? 3000000 + i : 1000000;
    b[i] = 4000000;
  }
  ASSERT_TRUE(ten.factor(a));
  ASSERT_TRUE(ten.solve(b, y, 40));
  for (int i = 0; i < 10; ++i) {
    Real sum = 0;
    for (int j = 0; j < 10; ++j) sum += static_cast<Real>(a[i][j]) * static_cast<Real>(y[j]);
    EXPECT_NEAR(static_cast<double>(sum * 0x1p-40L), 4e6, 1e-3);
  }
}

TEST(SymmetricEigen3, AgainstEigenInDouble) {
  Random random;
  double worst_value = 0, worst_rebuilt = 0, worst_orthogonality = 0;
  for (int n = 0; n < 20000; ++n) {
    berth::Mat3Unit m;
    for (int i = 0; i < 3; ++i) {
      for (int j = i; j < 3; ++j) m(i, j) = m(j, i) = nearest<30>(random.uniform(-0.65, 0.65));
    }
    if (n % 3 == 0) m(0, 2) = m(2, 0) = m(1, 2) = m(2, 1) = berth::Unit(0);
    const berth::SymmetricEigen3 e = berth::decompose_symmetric(m);
    const Eigen::Matrix3d v = real(e.vectors);
    const Eigen::Vector3d values(real(e.values[0]), real(e.values[1]), real(e.values[2]));
    const Eigen::Vector3d expected =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(real(m)).eigenvalues().reverse();
    worst_value = std::max(worst_value, (values - expected).cwiseAbs().maxCoeff());
    const Eigen::Matrix3d rebuilt = v * values.asDiagonal() * v.transpose();
    worst_rebuilt = std::max(worst_rebuilt, (rebuilt - real(m)).cwiseAbs().maxCoeff());
    const Eigen::Matrix3d gram = v.transpose() * v - Eigen::Matrix3d::Identity();
    worst_orthogonality = std::max(worst_orthogonality, gram.cwiseAbs().maxCoeff());
    EXPECT_GT(v.determinant(), 0.999);
  }
  EXPECT_LE(worst_value, 0x1p-30);
  EXPECT_LE(worst_rebuilt, 0x1p-28);
  EXPECT_LE(worst_orthogonality, 0x1p-29);
}

TEST(SymmetricEigen3, EqualValuesAndIdentity) {
  const berth::SymmetricEigen3 e = berth::decompose_symmetric(berth::Mat3Unit::Identity());
  for (const berth::Unit value : e.values) EXPECT_EQ(value, berth::Unit(1));
  EXPECT_TRUE(e.vectors == berth::Mat3Unit::Identity());
}

}  // namespace
}  // namespace berth_test
