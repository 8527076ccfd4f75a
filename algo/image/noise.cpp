#include "image/noise.hpp"

namespace berth {
namespace {

constexpr int kBins = 256;  // responses 0..254, the last one for all above
constexpr int kSamples = 4096;
constexpr int kMinSamples = 256;
// P(|z| < 0.3853) = 0.30, so the 30 % quantile of |response| is 0.3853 * 6 sigma = 2.312 sigma.
constexpr std::int32_t kQuantilePercent = 30;
constexpr std::int32_t kSigmaPerQuantileQ16 = 28348;  // 2^16 / 2.3118
constexpr std::uint16_t kRoundingNoiseQ8 = 74;        // sqrt(1/12) DN
// Responses are integers: the continuous quantile lies inside a bin and is interpolated there.

// The response and the clipping are the same for a complemented image: polarity does not matter.
int response(const ImageView& image, int x, int y) {
  const std::uint8_t* const middle = image.row(y) + x;
  const int c = *middle;
  // Clipped pixels carry no noise: 2 DN from the ends is beyond the rounding of calm ones.
  if (c < 2 || c > 253) return -1;
  const std::uint8_t *const above = middle - image.stride, *const below = middle + image.stride;
  const int corners = above[-1] + above[1] + below[-1] + below[1];
  const int sides = middle[-1] + middle[1] + above[0] + below[0];
  const int r = corners - 2 * sides + 4 * c;
  return r < 0 ? -r : r;
}

// Quantile in Q8 of a histogram of absolute values: bin k holds (k - 1/2, k + 1/2), bin 0 [0, 1/2).
std::int32_t quantile_q8(const std::uint16_t (&histogram)[kBins], std::int32_t total) {
  const std::int32_t wanted = total * kQuantilePercent / 100;
  std::int32_t below = 0;
  for (int k = 0; k < kBins; ++k) {
    if (below + histogram[k] > wanted) {
      const std::int32_t width_q8 = k == 0 ? 128 : 256;
      const std::int32_t start_q8 = k == 0 ? 0 : k * 256 - 128;
      return start_q8 + (wanted - below) * width_q8 / histogram[k];
    }
    below += histogram[k];
  }
  return (kBins - 1) * 256;
}

}  // namespace

std::uint16_t measure_noise_q8(const ImageView& image) {
  std::uint16_t histogram[kBins] = {};
  std::int32_t total = 0;
  // Additive recurrence over the frame (R2 sequence): even cover without hitting a grid's period.
  std::uint32_t u = 0x80000000u, v = 0x80000000u;
  const auto scale = [](std::uint32_t f, int n) {
    return static_cast<int>((std::uint64_t{f} * static_cast<std::uint32_t>(n)) >> 32);
  };
  for (int s = 0; s < kSamples; ++s) {
    u += 3242174889u;  // 2^32 * 0.7548776662
    v += 2447445414u;  // 2^32 * 0.5698402910
    const int r = response(image, 1 + scale(u, image.width - 2), 1 + scale(v, image.height - 2));
    if (r < 0) continue;
    ++histogram[r < kBins ? r : kBins - 1];
    ++total;
  }
  if (total < kMinSamples) return kRoundingNoiseQ8;
  const std::int32_t sigma = static_cast<std::int32_t>(
      (std::int64_t{quantile_q8(histogram, total)} * kSigmaPerQuantileQ16) >> 16);
  return narrow<std::uint16_t>(sigma < kRoundingNoiseQ8 ? kRoundingNoiseQ8 : sigma);
}

}  // namespace berth
