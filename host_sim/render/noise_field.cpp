#include "host_sim/render/noise_field.hpp"

#include "host_sim/render/random.hpp"

namespace berth::host {
namespace {

// Smooth step: no creases at the lattice.
float ease(float s) { return s * s * (3.0f - 2.0f * s); }

}  // namespace

void add_noise_field(uint64_t seed, int spacing_px, float amplitude, Plane& plane) {
  const int columns = plane.width / spacing_px + 2;
  const int rows = plane.height / spacing_px + 2;
  Random random(seed);
  std::vector<float> lattice(static_cast<size_t>(columns) * static_cast<size_t>(rows));
  for (float& value : lattice) value = amplitude * static_cast<float>(random.uniform(-1.0, 1.0));
  std::vector<float> weights(static_cast<size_t>(spacing_px));
  for (int i = 0; i < spacing_px; ++i) {
    weights[static_cast<size_t>(i)] = ease(static_cast<float>(i) / static_cast<float>(spacing_px));
  }
  std::vector<float> line(static_cast<size_t>(columns));
  for (int y = 0; y < plane.height; ++y) {
    const float s = weights[static_cast<size_t>(y % spacing_px)];
    const float* upper = lattice.data() + static_cast<size_t>(y / spacing_px) * line.size();
    const float* lower = upper + columns;
    for (int i = 0; i < columns; ++i)
      line[static_cast<size_t>(i)] = upper[i] + s * (lower[i] - upper[i]);
    float* out = plane.row(y);
    for (int first = 0; first < plane.width; first += spacing_px) {
      const float left = line[static_cast<size_t>(first / spacing_px)];
      const float step = line[static_cast<size_t>(first / spacing_px) + 1] - left;
      const int count = first + spacing_px > plane.width ? plane.width - first : spacing_px;
      for (int i = 0; i < count; ++i)
        out[first + i] += left + step * weights[static_cast<size_t>(i)];
    }
  }
}

}  // namespace berth::host
