// Eigen's fixed-size matrices over Q<F>, mixed formats included: Matrix<Q<30>,3,3> * Vector<Q<18>>
// is a vector of Q<18>. Only fixed sizes; Eigen's dynamic ones would draw in an allocator.
//
// Every term of a product is rounded; fixed/vector.hpp has products that round once. Sums and
// differences need one format on both sides, and so does dot() (Eigen's static assertion): mixing
// them would hide a conversion. Norms, inverses and decompositions of Eigen are not for this scalar
// (no sqrt or / is defined for it): fixed/vector.hpp and fixed/linear.hpp have them.
#pragma once

#include "fixed/eigen_assert.hpp"
// The line above must come first.
#include <Eigen/Core>

#include "fixed/q.hpp"

namespace Eigen {

template <int F>
struct NumTraits<berth::Q<F>> {
  using Real = berth::Q<F>;
  using NonInteger = berth::Q<F>;
  using Nested = berth::Q<F>;
  using Literal = int;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 0,
    ReadCost = 1,
    AddCost = 1,
    MulCost = 4
  };
  static constexpr Real epsilon() { return Real::from_raw(1); }
  static constexpr Real dummy_precision() { return Real::from_raw(4); }
  static constexpr Real highest() { return Real::max(); }
  static constexpr Real lowest() { return Real::lowest(); }
  static constexpr int digits10() { return 9; }
};

template <int A, int B>
struct ScalarBinaryOpTraits<berth::Q<A>, berth::Q<B>,
                            internal::scalar_product_op<berth::Q<A>, berth::Q<B>>> {
  using ReturnType = berth::Q<(A < B ? A : B)>;
};

template <int A>
struct ScalarBinaryOpTraits<berth::Q<A>, berth::Q<A>,
                            internal::scalar_product_op<berth::Q<A>, berth::Q<A>>> {
  using ReturnType = berth::Q<A>;
};

}  // namespace Eigen
