#include "host_sim/render/convolve.hpp"

#include <algorithm>
#include <cmath>

namespace berth::host {
namespace {

void add_scaled(float* __restrict out, const float* __restrict in, float weight, int count) {
  for (int i = 0; i < count; ++i) out[i] += weight * in[i];
}

// The kernel followed by the mean over a bin; element k acts on cell k - reach of the bin's first.
Kernel with_bin(const Kernel& kernel, int bin) {
  Kernel result(kernel.size() + static_cast<size_t>(bin) - 1, 0.0f);
  for (size_t i = 0; i < kernel.size(); ++i) {
    for (int b = 0; b < bin; ++b)
      result[i + static_cast<size_t>(b)] += kernel[i] / static_cast<float>(bin);
  }
  return result;
}

int floor_div(int a, int b) { return a >= 0 ? a / b : -((b - 1 - a) / b); }

}  // namespace

void convolve_taps(const ConstPlaneView& in, const std::vector<Tap>& taps, Plane& out) {
  out.reset(in.width, in.height);
  for (int y = 0; y < in.height; ++y) {
    for (const Tap& tap : taps) {
      const int source = y - tap.dy;
      if (source < 0 || source >= in.height) continue;
      const int first = std::max(0, tap.dx);
      const int count = in.width - std::abs(tap.dx);
      if (count > 0) {
        add_scaled(out.row(y) + first, in.row(source) + first - tap.dx, tap.weight, count);
      }
    }
  }
}

void convolve_rows(const ConstPlaneView& in, const Kernel& kernel, int bin, Plane& scratch,
                   Plane& out) {
  const Kernel binned = with_bin(kernel, bin);
  const int reach = static_cast<int>(kernel.size() / 2);
  const int width = in.width / bin;
  out.reset(width, in.height);
  // Cells of equal place in their bin side by side, so that the inner loop has unit stride.
  scratch.reset(width, bin);
  for (int y = 0; y < in.height; ++y) {
    const float* source = in.row(y);
    if (bin > 1) {
      for (int phase = 0; phase < bin; ++phase) {
        float* lane = scratch.row(phase);
        for (int x = 0; x < width; ++x) lane[x] = source[x * bin + phase];
      }
    }
    for (int k = 0; k < static_cast<int>(binned.size()); ++k) {
      const int offset = floor_div(k - reach, bin);
      const int phase = k - reach - offset * bin;
      const float* lane = bin > 1 ? scratch.row(phase) : source;
      const int first = std::max(0, -offset);
      const int count = width - std::abs(offset);
      if (count > 0) add_scaled(out.row(y) + first, lane + first + offset, binned[k], count);
    }
  }
}

void convolve_columns(const ConstPlaneView& in, const Kernel& kernel, int bin, Plane& out) {
  const Kernel binned = with_bin(kernel, bin);
  const int reach = static_cast<int>(kernel.size() / 2);
  out.reset(in.width, in.height / bin);
  for (int y = 0; y < out.height; ++y) {
    for (int k = 0; k < static_cast<int>(binned.size()); ++k) {
      const int source = y * bin + k - reach;
      if (source >= 0 && source < in.height) {
        add_scaled(out.row(y), in.row(source), binned[k], in.width);
      }
    }
  }
}

}  // namespace berth::host
