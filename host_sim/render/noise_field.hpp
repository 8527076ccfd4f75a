// Smooth random texture: octaves of value noise.
#pragma once

#include <cstdint>

#include "host_sim/render/convolve.hpp"

namespace berth::host {

/// Adds to `plane` values between -amplitude and amplitude, bicubic-like between random values on
/// a lattice of `spacing_px`.
void add_noise_field(uint64_t seed, int spacing_px, float amplitude, Plane& plane);

}  // namespace berth::host
