#include "target/verify_widths.hpp"

#include "fixed/linear.hpp"
#include "fixed/roots.hpp"
#include "fixed/trigonometry.hpp"

namespace berth {
namespace {

// Of 24: a quarter may be hidden, and some lie next to the raised dot; where more is disturbed the
// rest may be what hides the ring.
constexpr int kMinShare_q4 = 10;
constexpr int kUnknowns = 3;
constexpr int kSigmas = 4;

// What is neither noise nor common to ring and line: what blurs into their black from the other
// and from beyond the plate, and light that bends over the target: 2 % at most among 3000 targets
// of all conditions, gammas and point spreads. Shadows and what hides a part make more of it; finer
// differences are left to the outlines (pose/outline_sizes.hpp). 6 %.
constexpr int kModel = 246;

using Row = std::int64_t[kUnknowns];  // 1, cos 2x, sin 2x: 12 bits

void row_of(const SinCos& site, const SinCos& bar, Row& row) {
  const Unit across = site.sin * bar.cos - site.cos * bar.sin;
  const Unit along = site.cos * bar.cos + site.sin * bar.sin;
  row[0] = kOne;
  row[1] = shift_round(
      std::int64_t{across.raw()} * across.raw() - std::int64_t{along.raw()} * along.raw(), 48);
  row[2] = shift_round(std::int64_t{across.raw()} * along.raw(), 47);
}

struct Ratio {
  Row row;
  std::int64_t size;  // 12 bits
};
constexpr int kMaxDirections = 32;

// Black beside a profile that differs by a sixteenth of its contrast: something bright is near, a
// raised dot or what lies beyond the plate.
constexpr int kMaxSides = 16;

// The sum of a row by the solution x, 24 bits, with the row's 12.
std::int64_t at(const Row& row, const std::int64_t (&x)[kUnknowns]) {
  return shift_round(row[0] * x[0] + row[1] * x[1] + row[2] * x[2], 24);
}

struct Fit {
  bool is_known = false;
  std::int64_t size = 0, sigma = 0;  // at x = 0, 12 bits
};

Fit fit_direction(const Ratio (&ratio)[kMaxDirections], int count) {
  Fit fit;
  std::int64_t matrix[kUnknowns][kUnknowns] = {}, vector[kUnknowns] = {}, x[kUnknowns];
  for (int k = 0; k < count; ++k) {  // 24 products below 2^12 2^14
    for (int i = 0; i < kUnknowns; ++i) {
      for (int j = 0; j < kUnknowns; ++j) matrix[i][j] += ratio[k].row[i] * ratio[k].row[j];
      vector[i] += ratio[k].row[i] * ratio[k].size;
    }
  }
  SpdSystem<kUnknowns> system;
  if (!system.factor(matrix) || !system.solve(vector, x, 24)) return fit;
  const Row normal = {kOne, kOne, 0};
  fit.size = at(normal, x);
  std::int64_t square = 0;  // a ratio is within a fifth of the median, itself below 2^16
  for (int k = 0; k < count; ++k) {
    const std::int64_t off = ratio[k].size - at(ratio[k].row, x);
    square += off * off;
  }
  // Variance of a + b: that of a ratio by n^T A^-1 n.
  if (!system.solve(normal, x, 36)) return fit;
  const std::int64_t share = shift_round(x[0] + x[1], 12);  // 12 bits
  const std::int64_t variance = square * share / (kOne * (count - kUnknowns));
  fit.sigma = static_cast<std::int64_t>(isqrt(static_cast<std::uint64_t>(variance))) + 1;
  fit.is_known = fit.size > kOne / 4;  // or it is no band
  return fit;
}

}  // namespace

SizeRatio compare_widths(const TargetModel& target, const Sites& ring, int directions,
                         const Size& line, const BandLevels& left, Grey noise) {
  SizeRatio result;
  if (!line.is_known || 16 * ring.count < kMinShare_q4 * directions) return result;
  const SinCos bar = sin_cos(target.line_angle);
  const std::int64_t median = median_ratio(ring, 0, ring.count);
  Ratio ratio[kMaxDirections];
  int count = 0;
  for (int k = 0; k < ring.count && count < kMaxDirections; ++k) {
    const Site& s = ring.site[k];
    if (is_outlier(s, median) || kMaxSides * (s.sides - noise) > s.contrast) continue;
    row_of(sin_cos(part_of_turn(s.index, directions)), bar, ratio[count].row);
    ratio[count].size = std::int64_t{s.strength} * kOne / (std::int64_t{s.contrast} * kBandNominal);
    ++count;
  }
  if (16 * count < kMinShare_q4 * directions) return result;
  const Fit fit = fit_direction(ratio, count);
  if (!fit.is_known) return result;
  // Bands of two widths: blur takes more of the narrower one's middle, and gamma a part of that.
  const std::int64_t expected = fit.size * left.ring / left.line;
  const int unlike = left.ring < left.line ? left.line - left.ring : left.ring - left.line;
  const std::int64_t of_ring = fit.sigma * kOne / fit.size, of_line = line.sigma;
  const auto sigma =
      static_cast<int>(isqrt(static_cast<std::uint64_t>(of_ring * of_ring + of_line * of_line)));
  // A shadow's edge along the line takes a part of it, and leaves the rest leaning.
  const int of_shadow = (line.lean < 0 ? -line.lean : line.lean) / 2;
  result.is_known = true;
  result.off = static_cast<int>(line.ratio * std::int64_t{kOne} / expected) - kOne;
  result.tolerance = kModel + kSigmas * sigma + of_shadow + unlike / 4;
  return result;
}

}  // namespace berth
