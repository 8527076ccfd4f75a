#include "image/noise.hpp"

#include "image/packed.hpp"

namespace berth {
namespace {

constexpr int kBins = 256;  // responses 0..254, the last one for all above
// Two responses at each place, side by side: correlated by -2/3, they count nearly as two, and
// sigma has an error of 3.8 %.
constexpr int kPlaces = 1024;
constexpr int kMinSamples = 128;
// P(|z| < 0.3853) = 0.30, so the 30 % quantile of |response| is 0.3853 * 6 sigma = 2.312 sigma.
constexpr std::int32_t kQuantilePercent = 30;
constexpr std::int32_t kSigmaPerQuantileQ16 = 28348;  // 2^16 / 2.3118
constexpr std::uint16_t kRoundingNoiseQ8 = 74;        // sqrt(1/12) DN
// Responses are integers: the continuous quantile lies inside a bin and is interpolated there.

constexpr Pair kEven = both(0xff);  // of a word's bytes

// a - 2 m + b of every other byte, from the first on: |lane| <= 510.
Pair curvature(std::uint32_t a, std::uint32_t m, std::uint32_t b) {
  return subtract_pairs((a & kEven) + (b & kEven), 2 * (m & kEven));
}

// Clipped pixels carry no noise: 2 DN from the ends is beyond the rounding of calm ones.
bool is_clipped(std::uint32_t grey) { return grey - 2 > 251; }

// The response and the clipping are the same for a complemented image: polarity does not matter.
void count(std::int32_t response, std::uint16_t* counts) {
  const std::int32_t size = response < 0 ? -response : response;
  ++counts[size < kBins ? size : kBins - 1];
}

// The responses about the second and the third pixel of the row below `above`.
void count_two(const std::uint8_t* above, int stride, std::uint16_t* counts) {
  const std::uint32_t a = load(above), m = load(above + stride), b = load(above + 2 * stride);
  if (is_clipped(m >> 8 & 0xff) || is_clipped(m >> 16 & 0xff)) return;
  const Pair first_and_third = curvature(a, m, b);
  const Pair second_and_fourth = curvature(a >> 8, m >> 8, b >> 8);
  constexpr Pair kSides = both(1), kMiddleFirst = 0x0000fffe, kMiddleSecond = 0xfffe0000;
  const std::int32_t first = add_products(second_and_fourth, kMiddleFirst, 0);
  const std::int32_t second = add_products(first_and_third, kMiddleSecond, 0);
  count(add_products(first_and_third, kSides, first), counts);
  count(add_products(second_and_fourth, kSides, second), counts);
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
  const std::uint32_t columns = static_cast<std::uint32_t>(image.width - 3);
  const std::uint32_t rows = static_cast<std::uint32_t>(image.height - 2);
  const std::uint8_t* const first = hidden(image.pixels);
  std::uint16_t* const counts = hidden(static_cast<std::uint16_t*>(histogram));
  const std::uint32_t u_step = hidden(3242174889u);  // 2^32 * 0.7548776662
  const std::uint32_t v_step = hidden(2447445414u);  // 2^32 * 0.5698402910
  for (int s = 0; s < kPlaces; ++s) {
    u += u_step;
    v += v_step;
    count_two(first + scale(v, rows) * image.stride + scale(u, columns), image.stride, counts);
  }
  for (const std::uint16_t bin : histogram) total += bin;
  if (total < kMinSamples) return kRoundingNoiseQ8;
  const std::int32_t sigma = static_cast<std::int32_t>(
      (std::int64_t{quantile_q8(histogram, total)} * kSigmaPerQuantileQ16) >> 16);
  return narrow<std::uint16_t>(sigma < kRoundingNoiseQ8 ? kRoundingNoiseQ8 : sigma);
}

}  // namespace berth
