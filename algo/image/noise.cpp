#include "image/noise.hpp"

#include "image/packed.hpp"

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
int response(const std::uint8_t* above, int stride) {
  const std::uint8_t *const middle = above + stride, *const below = middle + stride;
  const int c = hidden(static_cast<int>(*middle));
  // Clipped pixels carry no noise: 2 DN from the ends is beyond the rounding of calm ones.
  if (c < 2 || c > 253) return -1;
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
  const auto scale = [](std::uint32_t f, std::uint32_t n) {
    return static_cast<int>((std::uint64_t{f} * n) >> 32);
  };
  const std::uint32_t columns = static_cast<std::uint32_t>(image.width - 2);
  const std::uint32_t rows = static_cast<std::uint32_t>(image.height - 2);
  const std::uint8_t* const first = hidden(image.pixels + 1);
  std::uint16_t* const counts = hidden(static_cast<std::uint16_t*>(histogram));
  const std::uint32_t u_step = hidden(3242174889u);  // 2^32 * 0.7548776662
  const std::uint32_t v_step = hidden(2447445414u);  // 2^32 * 0.5698402910
  for (int s = 0; s < kSamples; ++s) {
    u += u_step;
    v += v_step;
    const int r = response(first + scale(v, rows) * image.stride + scale(u, columns), image.stride);
    if (r >= 0) ++counts[r < kBins ? r : kBins - 1];
  }
  for (const std::uint16_t count : histogram) total += count;
  if (total < kMinSamples) return kRoundingNoiseQ8;
  const std::int32_t sigma = static_cast<std::int32_t>(
      (std::int64_t{quantile_q8(histogram, total)} * kSigmaPerQuantileQ16) >> 16);
  return narrow<std::uint16_t>(sigma < kRoundingNoiseQ8 ? kRoundingNoiseQ8 : sigma);
}

}  // namespace berth
