// Contiguous views: gsl::span from Debian's libmsgsl.
#pragma once

#include <cstdint>
#include <gsl/span>

namespace berth {

template <typename T>
using Span = gsl::span<T>;

}  // namespace berth
