#include "host_sim/render/sensor.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "host_sim/render/det_math.hpp"
#include "host_sim/render/random.hpp"
#include "host_sim/render/render.hpp"

namespace berth::host {
namespace {

void vignette(double loss, Plane& image) {
  const double cx = 0.5 * (image.width - 1);
  const double cy = 0.5 * (image.height - 1);
  const double corner2 = cx * cx + cy * cy;
  for (int y = 0; y < image.height; ++y) {
    float* row = image.row(y);
    for (int x = 0; x < image.width; ++x) {
      const double r2 = (x - cx) * (x - cx) + (y - cy) * (y - cy);
      row[x] *= static_cast<float>(1.0 - loss * r2 / corner2);
    }
  }
}

// The response by linear interpolation in a table; DN above 255 saturate first.
void apply_gamma(double gamma, Plane& image) {
  constexpr int kSteps = 4096;
  std::array<float, kSteps + 2> table{};
  for (int i = 0; i <= kSteps; ++i) {
    table[i] = static_cast<float>(255.0 * det_pow(static_cast<double>(i) / kSteps, gamma));
  }
  table[kSteps + 1] = table[kSteps];
  for (float& value : image.data) {
    const float s = std::min(255.0f, std::max(0.0f, value)) * (kSteps / 255.0f);
    const int i = static_cast<int>(s);
    value = table[i] + (s - static_cast<float>(i)) * (table[i + 1] - table[i]);
  }
}

}  // namespace

void respond(const Scene& scene, Plane& image) {
  if (scene.optics.vignetting != 0.0) vignette(scene.optics.vignetting, image);
  if (scene.light.stray_dn != 0.0) {
    const float stray = static_cast<float>(scene.light.stray_dn);
    for (float& value : image.data) value += stray;
  }
  if (scene.optics.gamma != 1.0) apply_gamma(scene.optics.gamma, image);
}

Image8 quantise(const std::vector<float>& noise_free, int width, int height, double sigma_dn,
                uint64_t noise_seed) {
  Image8 image{width, height, std::vector<uint8_t>(noise_free.size())};
  for (int y = 0; y < height; ++y) {
    Random random(noise_seed, static_cast<uint64_t>(y));
    const size_t first = static_cast<size_t>(y) * width;
    for (size_t i = first; i < first + static_cast<size_t>(width); ++i) {
      const double noise = sigma_dn > 0.0 ? sigma_dn * random.gaussian() : 0.0;
      const double value = std::clamp(noise_free[i] + noise + 0.5, 0.0, 255.0);
      image.data[i] = static_cast<uint8_t>(value);  // floor, since it is not negative
    }
  }
  return image;
}

}  // namespace berth::host
