// Sensor noise of a frame, measured in the frame itself.
//
// The response of Immerkaer's mask [1 -2 1; -2 4 -2; 1 -2 1] (Fast noise variance estimation, 1996)
// is blind to planes and straight edges along the axes; its standard deviation is 6 sigma. Where he
// takes the mean over the image we take a low quantile over a sparse sample, because structure only
// ever adds to the response: at least the calmest 30 % of the frame must be noise alone.
#pragma once

#include <cstdint>

#include "image/view.hpp"

namespace berth {

/// One standard deviation in DN, Q8, at least the rounding's own 0.29 DN. Clipped places do not
/// count. At least 4 x 3 pixels. Reads 1024 places of 4 x 3 pixels; about 60 k instructions.
std::uint16_t measure_noise_q8(const ImageView& image);

}  // namespace berth
