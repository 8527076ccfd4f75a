#include "pose/outline_normal.hpp"

#include "fixed/wide.hpp"
#include "pose/outline_profile.hpp"

namespace berth {
namespace {

constexpr std::int64_t kMinPixels = 16 * kFullWeight;
constexpr int kDisturbedSigmas = 5;
constexpr int kUnevenSigmas = 3;
constexpr int kExpectedSegments = 8;
constexpr int kDisturbedShare = 25;  // of the contrast: 4 %

}  // namespace

namespace {

void add_to_test(const SegmentSums& segment, std::int64_t normal, int axis, SlopeTest& light) {
  const std::int64_t square = shift_round(normal * normal, 16);  // Q<16>
  light.step_step[axis] += shift_round(square * segment.step_step, 16 + 17 - 12);
  light.slope_step[axis] += shift_round(square * segment.slope_step, 16 + 17 - 12);
  light.slope_slope[axis] += shift_round(square * (segment.slope_slope >> 13), 16 + 17 - 12);
  light.step_residual[axis] += shift_round(normal * segment.step_residual, 16 + 21 - 12);
  light.slope_residual[axis] += shift_round(normal * segment.slope_residual, 16 + 21 - 12);
}

// Q<5>, |j| <= 1.11 2^15: products of two fit 32 bits.
void fill_jacobian(const OutlineMiddle& middle, Px sigma_px, std::int32_t j[kOutlineUnknowns]) {
  for (int i = 0; i < 6; ++i) j[i] = middle.jacobian[i];
  // The offset moves the edge outwards by o s: delta = -o s. Below 6.4 px, 2^12.
  static_assert(kOffsetScale == 16);
  j[6] = -lowered(sigma_px.raw(), 16 - 4 - kJacobianFraction);
  const std::int32_t x = raised(middle.normal_x.raw(), 14), y = raised(middle.normal_y.raw(), 14);
  const std::int32_t offset = raised(j[6], 4);  // by Q<28>
  j[7] = multiply_high(offset, multiply_high(x, x) - multiply_high(y, y));
  j[8] = multiply_high(offset, 2 * multiply_high(x, y));
}

// Functions of their own, so that all stays in registers: unrolled, for each of a segment's many
// terms is four instructions instead of nine.
[[gnu::noinline]] void add_square(const std::int32_t (&j)[kOutlineUnknowns], std::int32_t weight,
                                  OutlineTriangle& matrix) {
  std::int64_t* term = matrix;
#pragma GCC unroll 9
  for (int i = 0; i < kOutlineUnknowns; ++i) {
#pragma GCC unroll 9
    for (int k = 0; k <= i; ++k) add_product(*term++, j[i] * j[k], weight);
  }
}

[[gnu::noinline]] void take_square(const std::int32_t (&u)[kOutlineUnknowns],
                                   OutlineTriangle& matrix) {
  std::int64_t* term = matrix;
#pragma GCC unroll 9
  for (int i = 0; i < kOutlineUnknowns; ++i) {
    const std::int32_t minus = -u[i];
#pragma GCC unroll 9
    for (int k = 0; k <= i; ++k) add_product(*term++, u[k], minus);
  }
}

[[gnu::noinline]] void add_multiple(const std::int32_t (&j)[kOutlineUnknowns], std::int32_t factor,
                                    std::int64_t (&sums)[kOutlineUnknowns]) {
#pragma GCC unroll 9
  for (int i = 0; i < kOutlineUnknowns; ++i) add_product(sums[i], j[i], factor);
}

}  // namespace

void add_segment(const SegmentSums& segment, const OutlineMiddle& middle, std::int32_t contrast,
                 const SegmentSize& size, SectorSums& sector) {
  sector.stations += segment.stations;
  sector.rejected += segment.rejected;
  if (segment.pixels == 0) return;
  std::int32_t j[kOutlineUnknowns];
  fill_jacobian(middle, segment.sigma_px, j);
  // C / s, DN/px Q<4>: below 2^14 with s >= 0.4.
  const auto steep = static_cast<std::int32_t>((static_cast<std::uint32_t>(contrast) << 16) /
                                               static_cast<std::uint32_t>(segment.sigma_px.raw()));
  // W = (C/s)^2 sum p^2: Q<8> 2^28 times Q<18> 2^21, to Q<4>. Saturated, as all sums here, at ten
  // times what a segment of 25 px at full contrast gives.
  const std::int32_t weight = saturate32(
      shift_round(steep * steep * std::int64_t{saturate32(segment.slope_slope >> 12)}, 22));
  const std::int64_t pull = -shift_round(steep * segment.slope_residual, 13);          // Q<12>
  const std::int32_t coarse_pull = saturate32(shift_round(pull, 4));                   // Q<8>
  const std::int32_t black = saturate32(-shift_round(steep * segment.slope, 8));       // Q<13>
  const std::int32_t white = saturate32(-shift_round(steep * segment.slope_step, 8));  // Q<13>
  add_square(j, weight, sector.matrix);
  add_multiple(j, coarse_pull, sector.vector);
  add_multiple(j, black, sector.by_black);
  add_multiple(j, white, sector.by_contrast);
  if (size.gain != 0) {
    SizeRow& s = sector.sizes[static_cast<int>(size.size) & 1];
    for (int i = 0; i < kOutlineUnknowns; ++i) {
      s.row[i] += std::int64_t{j[i] * size.gain} * weight;
    }
    s.self += std::int64_t{size.gain * size.gain} * weight;
    s.vector += std::int64_t{size.gain} * coarse_pull;
    s.by_black += std::int64_t{size.gain} * black;
    s.by_contrast += std::int64_t{size.gain} * white;
  }
  sector.step += segment.step;
  sector.step_step += segment.step_step;
  sector.residual += segment.residual;
  sector.step_residual += segment.step_residual;
  sector.square += segment.square;
  sector.pixels += segment.pixels;
  sector.information += weight;
  if (weight <= 0) return;
  // W delta^2: delta = pull / W in Q<16>, |delta| <= 4 px, so that the product stays below 2^49.
  ++sector.segments;
  const std::int32_t delta = short_quotient(coarse_pull, weight, 16 + 4 - 8);
  sector.displacement += std::int64_t{delta} * coarse_pull * (1 << 4);
}

void add_to_slope_test(const SegmentSums& segment, const OutlineMiddle& middle, SlopeTest& light) {
  add_to_test(segment, middle.normal_x.raw(), 0, light);
  add_to_test(segment, middle.normal_y.raw(), 1, light);
}

bool is_disturbed(const SegmentSums& segment, std::int32_t contrast, std::int32_t variance_q8) {
  if (segment.stations >= 2 && 2 * segment.rejected > segment.stations) return true;
  if (segment.pixels < 8 * kFullWeight) return false;
  // w P, w r of at most 25 stations of 25 pixels: 32 bits.
  const std::int32_t mean = saturate32(segment.step) / segment.pixels;  // Q<13>
  const std::int64_t spread =
      segment.step_step - ((mean * segment.step) >> kProfileFraction);  // Q<17>
  // A change of both levels shows in the mean residual, of the contrast in the residual along P.
  const std::int64_t shift = saturate32(segment.residual) / segment.pixels;          // DN Q<4>
  const std::int64_t shift_square = shift * shift * (segment.pixels / kFullWeight);  // DN^2 Q<8>
  const std::int64_t limit = std::int64_t{kDisturbedSigmas} * kDisturbedSigmas * variance_q8;
  const std::int64_t small = contrast / kDisturbedShare;
  if (shift_square > limit && (shift > small || shift < -small)) return true;
  if (spread <= 0) return false;
  const std::int64_t along = segment.step_residual - mean * segment.residual;       // Q<21>
  if (static_cast<std::int64_t>(magnitude(along)) <= small * spread) return false;  // below 2^44
  const std::int64_t change = QuickDivisor(spread).quotient(along);                 // DN Q<4>
  const std::int64_t change_square = change * change * (spread >> 17);              // DN^2 Q<8>
  return change_square > limit && (change > small || change < -small);
}

bool is_lit_unevenly(const SlopeTest& light, std::int32_t contrast, std::int32_t variance_q8) {
  constexpr std::int64_t kMost = std::int64_t{1} << 30;
  for (int i = 0; i < 2; ++i) {
    const std::int64_t shift = light.slope_slope[i];  // below 2^22
    const std::int64_t determinant =
        light.step_step[i] * shift - light.slope_step[i] * light.slope_step[i];  // Q<24>
    if (determinant <= 0) continue;
    std::int64_t slope =
        (light.step_residual[i] * shift - light.slope_residual[i] * light.slope_step[i]) >>
        18;  // times D, Q<6>
    if (slope < 0) slope = -slope;
    if (slope > kMost) slope = kMost;
    if (slope * 32 < (determinant >> 22) * contrast) continue;
    const std::int64_t variance = (shift * (determinant >> 12)) >> 12;  // Q<12>, below 2^41
    const std::int64_t sigmas = std::int64_t{kUnevenSigmas} * kUnevenSigmas * variance_q8;
    if (slope * slope > shift_round(variance * sigmas, 8)) return true;
  }
  return false;
}

bool solve_levels(const LevelSums& sums, std::int64_t pixels, LevelChange& change) {
  if (pixels < kMinPixels) return false;
  const std::int64_t mean = sums.step / pixels;                             // Q<13>
  const std::int64_t spread = sums.step_step - ((mean * sums.step) >> 13);  // Q<17>
  if (spread * 64 < pixels << 13) return false;                             // P hardly varies
  const std::int64_t contrast =
      (sums.step_residual - mean * sums.residual) / spread;  // Q<21> / Q<17>
  const std::int64_t black = (sums.residual - ((contrast * sums.step) >> 13)) / pixels;
  change.contrast = saturate32(contrast);
  change.black = saturate32(black);
  return true;
}

LevelBasis level_basis(const SectorSums& sector) {
  LevelBasis basis;
  if (sector.pixels < kMinPixels) return basis;
  basis.mean = saturate32(sector.step / sector.pixels);
  const std::int64_t spread =
      sector.step_step - ((basis.mean * sector.step) >> kProfileFraction);  // Q<17>
  if (spread <= 0) return basis;
  const std::uint32_t root_spread = isqrt(static_cast<std::uint64_t>(spread) << 15);
  if (root_spread < (1 << 14)) return basis;
  const std::uint32_t root_n = isqrt(static_cast<std::uint64_t>(sector.pixels) << 16);
  basis.twice_root_n = QuickDivisor(2 * std::int64_t{root_n});
  basis.root_spread = QuickDivisor(root_spread);
  basis.black = basis.twice_root_n.quotient(sector.residual * (1 << 13));
  basis.white =
      basis.root_spread.quotient((sector.step_residual - basis.mean * sector.residual) * (1 << 5));
  basis.valid = true;
  return basis;
}

void LevelBasis::project(std::int64_t by_black, std::int64_t by_contrast, std::int32_t& u,
                         std::int32_t& v) const {
  u = twice_root_n.quotient(by_black);
  const std::int64_t rest = by_contrast - shift_round((by_black >> 6) * mean, 7);
  v = root_spread.quotient(rest * (1 << 5));
}

void eliminate_levels(const LevelBasis& basis, SectorSums& sector) {
  std::int32_t u[kOutlineUnknowns], v[kOutlineUnknowns];  // Q<7>
  for (int i = 0; i < kOutlineUnknowns; ++i) {
    basis.project(sector.by_black[i], sector.by_contrast[i], u[i], v[i]);
    sector.vector[i] -=
        shift_round(std::int64_t{u[i]} * basis.black + std::int64_t{v[i]} * basis.white, 4);
  }
  take_square(u, sector.matrix);
  take_square(v, sector.matrix);
  // Censored pixels count less than their residuals: what would be more than there is, is not.
  const std::int64_t explained =
      shift_round(std::int64_t{basis.black} * basis.black + std::int64_t{basis.white} * basis.white,
                  8);  // Q<20> to Q<12>
  const std::int64_t most = sector.square - sector.square / 8;
  sector.explained = explained < most ? explained : most;
  for (SizeRow& size : sector.sizes) {
    if (size.self == 0) continue;
    std::int32_t of_black, of_white;
    basis.project(size.by_black, size.by_contrast, of_black, of_white);
    for (int i = 0; i < kOutlineUnknowns; ++i) {
      add_product(size.row[i], u[i], -of_black);
      add_product(size.row[i], v[i], -of_white);
    }
    add_product(size.self, of_black, -of_black);
    add_product(size.self, of_white, -of_white);
    size.vector -=
        shift_round(std::int64_t{of_black} * basis.black + std::int64_t{of_white} * basis.white, 4);
  }
}

std::int64_t gain_of_step(const SectorEquations& sector,
                          const std::int64_t (&step)[kOutlineUnknowns]) {
  // Matrix Q<-10> and vector Q<0> fit 32 bits, as steps do. A row is taken up to its diagonal: what
  // it says of the unknowns before is said twice.
  std::int32_t x[kOutlineUnknowns];
  std::int64_t gain = 0;  // Q<30>
  const std::int64_t* term = sector.matrix;
  for (int i = 0; i < kOutlineUnknowns; ++i) {
    x[i] = saturate32(step[i]);
    std::int64_t moved = 0;  // A x, Q<20>
    for (int k = 0; k < i; ++k) add_product(moved, saturate32(*term++ >> 24), x[k]);
    moved *= 2;
    add_product(moved, saturate32(*term++ >> 24), x[i]);
    const std::int64_t pull = 2 * (sector.vector[i] >> 13) - (moved >> 20);
    add_product(gain, saturate32(pull), x[i]);
  }
  return shift_round(gain, 18);
}

std::int64_t excess_q8(const SectorEquations& sector, std::int64_t gain, std::int32_t variance_q8) {
  if (variance_q8 <= 0) return 1 << 8;
  const std::int64_t left = shift_round(sector.displacement, 16) - gain;  // Q<12>
  const std::int64_t sum = left > 0 ? left * (1 << 4) / variance_q8 : 0;  // Q<8>
  const std::int64_t all = sum + kExpectedSegments * (1 << 8);
  const std::int64_t excess = all / (sector.segments + kExpectedSegments);
  return excess < 1 << 8 ? 1 << 8 : excess;
}

void add_sector(const SectorEquations& sector, std::int32_t weight, OutlineNormal& normal) {
  const auto weighed = [&](std::int64_t v) {
    return weight == kWholeSector ? v : shift_round(v * weight, 8);
  };
  // Matrix and vector have bits to spare at the lower end, none at the upper one.
  const auto weighed_high = [&](std::int64_t v) {
    return weight == kWholeSector ? v : shift_round(v, 8) * weight;
  };
  if (weight == kWholeSector) {
    for (int i = 0; i < kOutlineTerms; ++i) normal.matrix[i] += sector.matrix[i];
  } else {
    for (int i = 0; i < kOutlineTerms; ++i) normal.matrix[i] += weighed_high(sector.matrix[i]);
  }
  for (int i = 0; i < kOutlineUnknowns; ++i) {
    normal.vector[i] += weighed(sector.vector[i]) * (1 << 4);
  }
  const int first = static_cast<int>(sector.size) & ~1;
  for (int k = 0; k < 2; ++k) {
    const SizeRow& from = sector.sizes[k];
    if (from.self == 0) continue;
    SizeRow& to = normal.sizes[first + k];
    for (int i = 0; i < kOutlineUnknowns; ++i) to.row[i] += weighed_high(from.row[i]);
    to.self += weighed_high(from.self);
    to.vector += weighed(from.vector) * (1 << 4);
  }
  normal.square += weighed(sector.square);
  normal.explained += weighed(sector.explained);
  normal.pixels += weighed(sector.pixels);
  normal.information += weighed(sector.information);
  normal.displacement += weighed(sector.displacement);
}

}  // namespace berth
