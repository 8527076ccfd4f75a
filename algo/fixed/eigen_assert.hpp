// Eigen's assertions become range statements: include before any Eigen header.
//
// Eigen's own assertion draws in <cassert> with its formatted output and allocator; here a wrong
// index is a range violation like any other, proven absent by the range-checking build.
#pragma once

#include "core/check.hpp"

#if defined(EIGEN_CORE_H) && defined(__arm__)
#error "include fixed/eigen.hpp before, or instead of, Eigen/Core"
#endif

#if !defined(EIGEN_CORE_H) && (defined(__arm__) || BERTH_RANGE_CHECK)
#define eigen_assert(condition) BERTH_RANGE(condition)
#endif

#if !defined(EIGEN_CORE_H)
// No blocked products: their panels are heap memory, and they cannot mix formats.
#define EIGEN_CACHEFRIENDLY_PRODUCT_THRESHOLD 64
#endif

#if defined(__arm__)
#define EIGEN_DONT_VECTORIZE
#define EIGEN_NO_IO
#endif
