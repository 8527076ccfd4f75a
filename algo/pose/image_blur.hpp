// The blur of an image about the target, as straight edges see it.
#pragma once

#include "fixed/q.hpp"

namespace berth {

/// Blur of the image as a covariance, px^2; pixel area included.
struct ImageBlur {
  Q<16> xx = q<16>(1.0), xy, yy = q<16>(1.0);
};
constexpr ImageBlur kUnknownBlur{Q<16>(0), Q<16>(0), Q<16>(0)};

}  // namespace berth
