// Blurring of planes of floats; loops over rows that compilers turn into vector instructions.
#pragma once

#include <vector>

#include "host_sim/render/psf.hpp"

namespace berth::host {

/// A plane of floats, row by row.
struct Plane {
  int width = 0;
  int height = 0;
  std::vector<float> data;

  void reset(int new_width, int new_height, float value = 0.0f) {
    width = new_width;
    height = new_height;
    data.assign(static_cast<size_t>(width) * height, value);
  }
  float* row(int y) { return data.data() + static_cast<size_t>(y) * width; }
  const float* row(int y) const { return data.data() + static_cast<size_t>(y) * width; }
};

/// Rows of cells that may have a stride of their own.
struct ConstPlaneView {
  const float* data = nullptr;
  size_t stride = 0;
  int width = 0;
  int height = 0;
  const float* row(int y) const { return data + static_cast<size_t>(y) * stride; }
};

inline ConstPlaneView view_of(const Plane& p) {
  return {p.data.data(), static_cast<size_t>(p.width), p.width, p.height};
}

/// out(x, y) = sum of weight * in(x - dx, y - dy); zero outside the plane.
void convolve_taps(const ConstPlaneView& in, const std::vector<Tap>& taps, Plane& out);

/// Convolves the rows with `kernel` and sums `bin` cells to their mean: out is width / bin wide.
void convolve_rows(const ConstPlaneView& in, const Kernel& kernel, int bin, Plane& scratch,
                   Plane& out);

/// The same along columns: out is height / bin high.
void convolve_columns(const ConstPlaneView& in, const Kernel& kernel, int bin, Plane& out);

}  // namespace berth::host
