#include "pose/outline_edges.hpp"

#include "fixed/wide.hpp"
#include "pose/outline_segment.hpp"

namespace berth {
namespace {

constexpr std::int64_t kOne16 = std::int64_t{1} << 16;

std::int32_t to32(std::int64_t v) { return narrow<std::int32_t>(v); }
std::int64_t times(std::int64_t a, std::int64_t b) { return shift_round(a * b, 16); }  // Q<16>

// A level near an end of the scale: its mean after clipping, and how far that follows the level.
struct Clipped {
  std::int32_t level, share;  // DN Q<8>; Q<13>
};

Clipped clip(const PixelModel& model, std::int32_t level) {
  const bool is_high = level > model.high;
  const std::int32_t room = is_high ? kScaleEnd - level : level;
  // Q<12>; beyond 4 sigma the profile is flat.
  const std::int32_t near = room < -8 * model.noise ? -8 * model.noise : room;
  const std::int32_t z = (near * model.per_noise) >> 8;
  const ProfileValue normal = look_up(edge_profile(0), z);
  // sigma g(-z) = sigma phi(z) - room (1 - Phi(z))
  const std::int32_t tail = (1 << kProfileFraction) - normal.step;
  const std::int32_t missing = (model.noise * normal.slope - room * tail) >> kProfileFraction;
  return {is_high ? level - missing : level + missing, normal.step};
}

// Sums of one station; 32 bits hold them: 25 pixels, |r| <= 2^12.6, P, p <= 2^13.
struct StationSums {
  std::int32_t slope_residual = 0, slope_slope = 0, blur_residual = 0, blur_blur = 0;
  std::int32_t slope = 0, slope_step = 0, step = 0, step_step = 0, blur = 0, blur_step = 0;
  std::int32_t residual = 0, step_residual = 0, square = 0;
  std::int32_t pixels = 0;  // sum of q, Q<4>
};

// Where a station's first pixel lies, Q<12> px, and its own share of the model.
struct StationModel {
  std::int32_t e, linear, x0, pulse;  // linear: Q<14>
};

StationSums measure_station(const PixelModel& model, const std::uint8_t* pixel, int stride,
                            int count, std::uint8_t polarity, const StationModel& station) {
  StationSums s;
  std::int32_t e_q12 = station.e;
  std::int32_t black = model.black + ((e_q12 * model.black_per_px) >> 12);
  std::int32_t contrast = model.contrast + ((e_q12 * model.contrast_per_px) >> 12);
  constexpr int kHalf = 1 << (kProfileFraction - 1);
  for (int i = 0; i < count; ++i, pixel += stride, e_q12 += 1 << 12) {  // at most kMaxWindow
    const std::int32_t bent = model.quadratic + ((e_q12 * model.cubic) >> 12);
    const std::int32_t rise = station.linear + ((e_q12 * bent) >> 12);
    const auto x =
        static_cast<std::int32_t>(station.x0 + shift_round(std::int64_t{e_q12} * rise, 14));
    ProfileValue p = look_up(*model.profile, x);
    std::int32_t h = (p.slope * x) >> 12;
    if (model.skew != 0) {
      p.step += (model.skew * (p.slope - ((h * x) >> 12)) + kHalf) >> kProfileFraction;
    }
    if (station.pulse != 0) {
      const ProfileValue other = look_up(*model.profile, station.pulse - x);
      p.step += other.step - (1 << kProfileFraction);
      p.slope -= other.slope;
      h += (other.slope * (station.pulse - x)) >> 12;
    }
    std::int32_t level = black + ((contrast * p.step + kHalf) >> kProfileFraction);  // Q<8>
    std::int32_t one = 1 << kProfileFraction, slope = p.slope, bulge = h, step = p.step;
    if (level > model.high || level < model.low) {
      const Clipped clipped = clip(model, level);
      level = clipped.level;
      one = clipped.share;
      slope = (slope * one + kHalf) >> kProfileFraction;
      bulge = (bulge * one + kHalf) >> kProfileFraction;
      step = (step * one + kHalf) >> kProfileFraction;
    }
    const std::int32_t r = ((*pixel ^ polarity) << kLevelFraction) - ((level + 8) >> 4);
    black += model.black_per_px;
    contrast += model.contrast_per_px;
    s.slope_residual += p.slope * r;
    s.slope_slope += slope * p.slope;
    s.blur_residual += h * r;
    s.blur_blur += bulge * h;
    s.blur += bulge;
    s.blur_step += (bulge * p.step + kHalf) >> kProfileFraction;
    s.slope += slope;
    s.slope_step += (slope * p.step + kHalf) >> kProfileFraction;
    s.step += step;
    s.step_step += (step * p.step + kHalf) >> kProfileFraction;
    s.residual += r;
    s.step_residual += p.step * r;
    s.square += r * r;
    s.pixels += one;
  }
  s.pixels = (s.pixels + (1 << 8)) >> (kProfileFraction - 4);
  return s;
}

// Full weight up to four times the ordinary mean square, then falling with its square.
std::int32_t robust_weight(const StationSums& s, const SegmentModel& model) {
  if (model.ordinary_q8 == 0) return kFullWeight;
  // Up to 1.6 % of the contrast may be the profile's own error.
  const std::int64_t small = model.contrast / 64;  // Q<4>
  const std::int64_t ordinary = model.ordinary_q8 + small * small;
  const std::int64_t limit = (ordinary * s.pixels) >> 2;  // 4 times, Q<4>
  std::int32_t weight = kFullWeight;
  if (s.square > limit) {
    const auto ratio = static_cast<std::int32_t>((limit << 4) / s.square);  // < 16
    weight = (ratio * ratio) >> 4;
  }
  if (model.judge_shift) {
    // (p r)^2 / (p p) is the square that a shift explains: above 12 sigma^2 it is no noise, and
    // above (C / 32)^2 p p, a shift by 0.03 of the blur, no error of the profile.
    const std::int64_t shift = std::int64_t{s.slope_residual} * s.slope_residual;  // Q<34>
    const std::int64_t coarse = s.slope_slope >> 13;                               // Q<13>
    const std::int64_t bound = std::int64_t{12} * model.ordinary_q8 * s.slope_slope +
                               4 * small * small * coarse * coarse;  // Q<34>, second term < 2^52
    if (shift > 4 * bound) return 0;
    if (shift > bound) weight /= 4;
  }
  return weight;
}

void add_station(const StationSums& s, std::int32_t weight, SegmentSums& sums) {
  const std::int64_t w = weight;
  sums.slope_residual += w * s.slope_residual;
  sums.slope_slope += w * s.slope_slope;
  sums.blur_residual += w * s.blur_residual;
  sums.blur_blur += w * s.blur_blur;
  sums.slope += w * s.slope;
  sums.blur += w * s.blur;
  sums.blur_step += w * s.blur_step;
  sums.slope_step += w * s.slope_step;
  sums.step += w * s.step;
  sums.step_step += w * s.step_step;
  sums.residual += w * s.residual;
  sums.step_residual += w * s.step_residual;
  sums.square += w * s.square;
  sums.pixels += (weight * s.pixels) >> 4;
}

}  // namespace

void ResidualHistogram::add(std::uint32_t mean_square_q8) {
  const std::uint32_t v = mean_square_q8 < 16 ? 16 : mean_square_q8;
  const int octave = 31 - leading_zeros32(v);  // >= 4
  const int fraction = static_cast<int>((v >> (octave - 3)) & 7);
  const int index = (octave - 4) * 8 + fraction;
  ++count[index < kClasses ? index : kClasses - 1];
  ++total;
}

std::int32_t ResidualHistogram::median_q8() const {
  std::int32_t seen = 0;
  for (int i = 0; i < kClasses; ++i) {
    seen += count[i];
    if (2 * seen >= total && seen > 0) {
      const std::int64_t middle = std::int64_t{2 * (8 + i % 8) + 1}
                                  << (i / 8);  // (8 + f + 1/2) 2^(o-3)
      return saturate32(middle);
    }
  }
  return 0;
}

namespace {

struct Reach {
  std::int64_t inside, outside;  // along the scan line, px Q<16>
};

// Rows and columns share the inside of a small circle at its diagonals, so that no pixel is used
// twice: from the edge to there it is (|n_u| - |n_m|) / kappa.
Reach reach_at(const PixelModel& model, std::int32_t curvature, std::int64_t wedge) {
  Reach reach{model.inside, model.outside};
  const std::int64_t bend = static_cast<std::int64_t>(magnitude(std::int64_t{curvature}));
  std::int64_t& hollow = curvature > 0 ? reach.inside : reach.outside;
  if (wedge < 0) wedge = 0;
  if (times(hollow, bend) > wedge) hollow = (wedge << 16) / bend;
  return reach;
}

// The station on scan line m, or nothing to look at: count 0.
struct Station {
  StationModel model;
  int place = 0, count = 0;  // first pixel, pixels
};

Station make_station(const ScanCurve& curve, const PixelModel& pixels, std::int64_t m, int places) {
  Station station;
  const std::int64_t tau = (m << 16) - curve.m0;
  const std::int64_t share = curve.share_at(tau);
  const std::int64_t u = curve.place_at(tau, share);
  const std::int64_t wedge = curve.wedge + shift_round(curve.wedge_gain * share, 20);
  const Reach reach = reach_at(pixels, curve.curvature, wedge);
  const bool white_ahead = curve.normal > 0;
  const std::int64_t begin = (u - (white_ahead ? reach.outside : reach.inside) + kOne16 - 1) >> 16;
  const std::int64_t last = (u + (white_ahead ? reach.inside : reach.outside)) >> 16;
  if (begin < 0 || last >= places || last - begin >= kMaxWindow || last - begin < 2) return station;
  station.place = static_cast<int>(begin);
  station.count = static_cast<int>(last - begin + 1);
  const std::int64_t from_middle = curve.swapped ? (1 << 19) - share : share - (1 << 19);
  const auto gain = [&](std::int32_t from_end_to_end) {
    return shift_round(from_end_to_end * from_middle, 20);
  };
  const std::int64_t n_u = curve.normal + shift_round(curve.normal_gain * share, 20);
  station.model.e = to32(shift_round((begin << 16) - u, 4));
  station.model.linear =
      to32(shift_round(n_u * (pixels.one_over_sigma + gain(pixels.one_over_sigma_gain)), 18));
  station.model.x0 = to32(pixels.x0 + gain(pixels.x0_gain));
  station.model.pulse = pixels.pulse == 0 ? 0 : to32(pixels.pulse + gain(pixels.pulse_gain));
  return station;
}

}  // namespace

void measure_segment(const ImageView& image, const OutlinePiece& piece, const OutlineVertex& a,
                     const OutlineVertex& b, const SegmentModel& model, SegmentSums& sums,
                     ResidualHistogram& histogram) {
  sums = SegmentSums{};
  ScanCurve curve;
  PixelModel pixels;
  if (!a.visible || !b.visible || !make_scan_curve(a, b, curve)) return;
  if (!make_pixel_model(piece, a, b, model, curve, pixels, sums.sigma_px)) return;
  const int lines = curve.rows ? image.height : image.width;
  const int places = curve.rows ? image.width : image.height;
  const int step = curve.rows ? 1 : image.stride;
  std::int64_t first = (std::int64_t{curve.m0} + kOne16 - 1) >> 16;
  std::int64_t end = (std::int64_t{curve.m0} + curve.length + kOne16 - 1) >> 16;
  if (first < 0) first = 0;
  first = (first + model.stride - 1) & -std::int64_t{model.stride};
  if (end > lines) end = lines;
  for (std::int64_t m = first; m < end; m += model.stride) {  // at most the image's side
    const Station station = make_station(curve, pixels, m, places);
    if (station.count == 0) continue;
    const auto line = static_cast<int>(m);
    const std::uint8_t* start = curve.rows ? image.pixels + line * image.stride + station.place
                                           : image.pixels + station.place * image.stride + line;
    const StationSums here =
        measure_station(pixels, start, step, station.count, image.polarity_mask, station.model);
    if (here.pixels < 2 << 4) continue;  // all at the scale's end
    histogram.add(static_cast<std::uint32_t>((std::int64_t{here.square} << 4) / here.pixels));
    const std::int32_t weight = robust_weight(here, model);
    ++sums.stations;
    if (weight < kFullWeight / 4) ++sums.rejected;
    add_station(here, weight, sums);
  }
}

}  // namespace berth
