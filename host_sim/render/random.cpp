#include "host_sim/render/random.hpp"

#include <array>
#include <cmath>

#include "host_sim/render/det_math.hpp"

namespace berth::host {
namespace {

// The ziggurat of Marsaglia and Tsang (2000) in Doornik's form (2005): 128 layers of equal area
// kArea; kTail is where the tail begins.
constexpr int kLayers = 128;
constexpr double kTail = 3.442619855899;
constexpr double kArea = 9.91256303526217e-3;

struct Ziggurat {
  std::array<double, kLayers + 1> x{};
  std::array<double, kLayers> ratio{};

  Ziggurat() {
    double density = det_exp(-0.5 * kTail * kTail);
    x[0] = kArea / density;
    x[1] = kTail;
    for (int i = 2; i < kLayers; ++i) {
      x[i] = std::sqrt(-2.0 * det_log(kArea / x[i - 1] + density));
      density = det_exp(-0.5 * x[i] * x[i]);
    }
    x[kLayers] = 0.0;
    for (int i = 0; i < kLayers; ++i) ratio[i] = x[i + 1] / x[i];
  }
};

const Ziggurat kZiggurat;

double sample_tail(Random& random, bool is_negative) {
  double x = 0.0;
  double y = 0.0;
  do {
    x = det_log(1.0 - random.uniform()) / kTail;
    y = det_log(1.0 - random.uniform());
  } while (-2.0 * y < x * x);
  return is_negative ? x - kTail : kTail - x;
}

}  // namespace

double Random::gaussian() {
  const Ziggurat& z = kZiggurat;
  for (;;) {
    const uint64_t word = bits();
    const int layer = static_cast<int>(word & (kLayers - 1));
    const double u = static_cast<double>(static_cast<int64_t>(word) >> 11) * 0x1p-52;
    const double x = u * z.x[layer];
    if (std::abs(u) < z.ratio[layer]) return x;
    if (layer == 0) return sample_tail(*this, u < 0.0);
    const double upper = det_exp(-0.5 * (z.x[layer] * z.x[layer] - x * x));
    const double lower = det_exp(-0.5 * (z.x[layer + 1] * z.x[layer + 1] - x * x));
    if (lower + uniform() * (upper - lower) < 1.0) return x;
  }
}

}  // namespace berth::host
