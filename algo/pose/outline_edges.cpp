#include "pose/outline_edges.hpp"

#include "fixed/wide.hpp"
#include "pose/outline_segment.hpp"

namespace berth {
namespace {

constexpr std::int32_t kOne16 = 1 << 16;

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

// Sums of one station; 32 bits hold them: 25 pixels, |r| <= 2^12.1 once censored, P, p <= 2^13.
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

// x + kProfileReach along a run of pixels by its differences, Q<24>: the cubic
// x0 + linear e + quadratic e^2 + cubic e^3 at e, e + 1, ... to 2^-16 over 25 pixels.
struct PlaceSteps {
  std::uint32_t y, first, second, third;

  PlaceSteps(const PixelModel& model, const StationModel& station) {
    constexpr std::int32_t kOne = 1 << 12;
    const std::int32_t e = station.e;
    const auto square = static_cast<std::int32_t>((std::int64_t{e} * e) >> 12);     // Q<12>
    const auto cube = static_cast<std::int32_t>((std::int64_t{square} * e) >> 12);  // Q<12>
    const auto poly = [&](std::int32_t of_linear, std::int32_t of_quadratic,
                          std::int32_t of_cubic) {  // Q<26> to Q<24>
      return static_cast<std::uint32_t>((std::int64_t{station.linear} * of_linear +
                                         std::int64_t{model.quadratic} * of_quadratic +
                                         std::int64_t{model.cubic} * of_cubic) >>
                                        2);
    };
    constexpr std::uint32_t kHalf = 1u << 11;  // x is rounded to Q<12>
    const auto start = static_cast<std::uint32_t>(station.x0 + kProfileReach * kOne);
    y = (start << 12) + kHalf + poly(e, square, cube);
    first = poly(kOne, 2 * e + kOne, 3 * square + 3 * e + kOne);
    second = poly(0, 2 * kOne, 6 * e + 6 * kOne);
    third = poly(0, 0, 6 * kOne);
  }
  void advance() {
    y += first;
    first += second;
    second += third;
  }
};

// What a station's pixels should show, pixel by pixel in pairs; a lone last one has zeros beside
// it. Q<13>; residuals Q<4>.
struct Window {
  static constexpr int kPairs = (kMaxWindow + 1) / 2;
  alignas(4) std::int16_t slope[2 * kPairs], bulge[2 * kPairs], step[2 * kPairs];
  alignas(4) std::int16_t residual[2 * kPairs];
};

constexpr int kHalf = 1 << (kProfileFraction - 1);

// P, p and h of each pixel.
void fill_shape(const PixelModel& model, const StationModel& station, int count, Window& window) {
  PlaceSteps place(model, station);
  const EdgeProfile& profile = *model.profile;
  for (int i = 0; i < count; ++i, place.advance()) {  // at most kMaxWindow
    const ProfileValue p = look_up_from_start(profile, place.y);
    const std::int32_t x = (static_cast<std::int32_t>(place.y) >> 12) - kProfileReach * 4096;
    window.step[i] = static_cast<std::int16_t>(p.step);
    window.slope[i] = static_cast<std::int16_t>(p.slope);
    window.bulge[i] = static_cast<std::int16_t>((p.slope * x) >> 12);
  }
}

// The same with skew and opposite edge.
void fill_rare_shape(const PixelModel& model, const StationModel& station, int count,
                     Window& window) {
  PlaceSteps place(model, station);
  const std::uint32_t turned = static_cast<std::uint32_t>(station.pulse + 2 * kProfileReach * 4096)
                               << 12;
  for (int i = 0; i < count; ++i, place.advance()) {  // at most kMaxWindow
    ProfileValue p = look_up_from_start(*model.profile, place.y);
    const std::int32_t x = (static_cast<std::int32_t>(place.y) >> 12) - kProfileReach * 4096;
    std::int32_t h = (p.slope * x) >> 12;
    if (model.skew != 0) {
      p.step += (model.skew * (p.slope - ((h * x) >> 12)) + kHalf) >> kProfileFraction;
    }
    if (station.pulse != 0) {
      const ProfileValue other = look_up_from_start(*model.profile, turned - place.y);
      p.step += other.step - (1 << kProfileFraction);
      p.slope -= other.slope;
      h += (other.slope * (station.pulse - x)) >> 12;
    }
    window.step[i] = static_cast<std::int16_t>(p.step);
    window.slope[i] = static_cast<std::int16_t>(p.slope);
    window.bulge[i] = static_cast<std::int16_t>(h);
  }
}

// A station's pixels in the image.
struct Run {
  const std::uint8_t* start;
  int stride, count;
  std::uint8_t polarity;
};

// Residuals; false where some level lies so near to an end of the scale that it is censored.
bool fill_residuals(const PixelModel& model, const Run& run, const StationModel& station,
                    Window& window) {
  std::int32_t black = model.black + ((station.e * model.black_per_px) >> 12);
  std::int32_t contrast = model.contrast + ((station.e * model.contrast_per_px) >> 12);
  const std::int32_t black_per_px = model.black_per_px, contrast_per_px = model.contrast_per_px;
  const std::int32_t low = model.low;
  const auto room = static_cast<std::uint32_t>(model.high - low);
  const std::uint8_t* pixel = run.start;
  for (int i = 0; i < run.count; ++i, pixel += run.stride) {
    const std::int32_t level =
        black + ((contrast * window.step[i] + kHalf) >> kProfileFraction);  // Q<8>
    if (static_cast<std::uint32_t>(level - low) > room) return false;
    window.residual[i] =
        static_cast<std::int16_t>(((*pixel ^ run.polarity) << kLevelFraction) - ((level + 8) >> 4));
    black += black_per_px;
    contrast += contrast_per_px;
  }
  return true;
}

// Residuals to the means of clipped levels; `shares` gets q of each pixel, Q<13>.
void fill_censored_residuals(const PixelModel& model, const Run& run, const StationModel& station,
                             Window& window, std::int16_t* shares) {
  std::int32_t black = model.black + ((station.e * model.black_per_px) >> 12);
  std::int32_t contrast = model.contrast + ((station.e * model.contrast_per_px) >> 12);
  const std::uint8_t* pixel = run.start;
  for (int i = 0; i < run.count; ++i, pixel += run.stride) {
    std::int32_t level = black + ((contrast * window.step[i] + kHalf) >> kProfileFraction);
    shares[i] = 1 << kProfileFraction;
    if (level < model.low || level > model.high) {
      const Clipped clipped = clip(model, level);
      level = clipped.level;
      shares[i] = static_cast<std::int16_t>(clipped.share);
    }
    window.residual[i] =
        static_cast<std::int16_t>(((*pixel ^ run.polarity) << kLevelFraction) - ((level + 8) >> 4));
    black += model.black_per_px;
    contrast += model.contrast_per_px;
  }
}

// q times a factor of the window; both Q<13>.
void censor(const std::int16_t* factor, const std::int16_t* shares, int count, std::int16_t* out) {
  for (int i = 0; i < count; ++i) {
    out[i] = static_cast<std::int16_t>((factor[i] * shares[i] + kHalf) >> kProfileFraction);
  }
}

void clear_last(Window& window, int i) {
  window.slope[i] = window.bulge[i] = window.step[i] = window.residual[i] = 0;
}

// Sums of products; a factor that is squared goes with its weighed self. In two passes, so that the
// sums of each stay in registers.
inline StationSums sum_window(const Window& window, const Window& weighed, int count) {
  constexpr Pair kOnes = both(1);
  StationSums s;
  for (int i = 0; i < count; i += 2) {
    const Pair p = load(&window.slope[i]), m = load(&window.step[i]);
    const Pair r = load(&window.residual[i]);
    const Pair wp = load(&weighed.slope[i]), wm = load(&weighed.step[i]);
    s.slope_residual = add_products(p, r, s.slope_residual);
    s.step_residual = add_products(m, r, s.step_residual);
    s.slope_slope = add_products(wp, p, s.slope_slope);
    s.slope_step = add_products(wp, m, s.slope_step);
    s.slope = add_products(wp, kOnes, s.slope);
    s.step_step = add_products(wm, m, s.step_step);
    s.step = add_products(wm, kOnes, s.step);
  }
  for (int i = 0; i < count; i += 2) {
    const Pair h = load(&window.bulge[i]), m = load(&window.step[i]);
    const Pair r = load(&window.residual[i]);
    const Pair wh = load(&weighed.bulge[i]);
    s.blur_residual = add_products(h, r, s.blur_residual);
    s.blur_blur = add_products(wh, h, s.blur_blur);
    s.blur_step = add_products(wh, m, s.blur_step);
    s.blur = add_products(wh, kOnes, s.blur);
    s.square = add_products(r, r, s.square);
    s.residual = add_products(r, kOnes, s.residual);
  }
  s.slope_step = (s.slope_step + kHalf) >> kProfileFraction;
  s.blur_step = (s.blur_step + kHalf) >> kProfileFraction;
  s.step_step = (s.step_step + kHalf) >> kProfileFraction;
  return s;
}

[[gnu::noinline]] StationSums measure_censored(const PixelModel& model, const Run& run,
                                               const StationModel& station, Window& window) {
  std::int16_t shares[kMaxWindow];
  Window weighed;
  fill_censored_residuals(model, run, station, window, shares);
  censor(window.slope, shares, run.count, weighed.slope);
  censor(window.bulge, shares, run.count, weighed.bulge);
  censor(window.step, shares, run.count, weighed.step);
  if (run.count % 2 != 0) clear_last(weighed, run.count);
  StationSums s = sum_window(window, weighed, run.count);
  for (int i = 0; i < run.count; ++i) s.pixels += shares[i];
  s.pixels = (s.pixels + (1 << 8)) >> (kProfileFraction - 4);
  return s;
}

StationSums measure_station(const PixelModel& model, const Run& run, const StationModel& station) {
  Window window;
  if (model.skew == 0 && station.pulse == 0) {
    fill_shape(model, station, run.count, window);
  } else {
    fill_rare_shape(model, station, run.count, window);
  }
  if (run.count % 2 != 0) clear_last(window, run.count);
  if (!fill_residuals(model, run, station, window)) {
    return measure_censored(model, run, station, window);
  }
  StationSums s = sum_window(window, window, run.count);
  s.pixels = run.count << 4;
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
  add_product(sums.slope_residual, s.slope_residual, weight);
  add_product(sums.slope_slope, s.slope_slope, weight);
  add_product(sums.blur_residual, s.blur_residual, weight);
  add_product(sums.blur_blur, s.blur_blur, weight);
  add_product(sums.slope, s.slope, weight);
  add_product(sums.blur, s.blur, weight);
  add_product(sums.blur_step, s.blur_step, weight);
  add_product(sums.slope_step, s.slope_step, weight);
  add_product(sums.step, s.step, weight);
  add_product(sums.step_step, s.step_step, weight);
  add_product(sums.residual, s.residual, weight);
  add_product(sums.step_residual, s.step_residual, weight);
  add_product(sums.square, s.square, weight);
  sums.pixels += (weight * s.pixels) >> 4;
}

struct Reach {
  std::int32_t inside, outside;  // along the scan line, px Q<16>
};

// Rows and columns share the inside of a small circle at its diagonals, so that no pixel is used
// twice: from the edge to there it is (|n_u| - |n_m|) / kappa.
Reach reach_at(const PixelModel& model, std::int32_t curvature, std::int32_t wedge) {
  Reach reach{model.inside, model.outside};
  std::int32_t& hollow = curvature > 0 ? reach.inside : reach.outside;
  const std::uint64_t room =
      (static_cast<std::uint64_t>(wedge > 0 ? wedge : 0) * model.per_curvature) >> 16;
  if (room < static_cast<std::uint32_t>(hollow)) hollow = static_cast<std::int32_t>(room);
  return reach;
}

// The station on scan line m, or nothing to look at: count 0.
struct Station {
  StationModel model;
  int place = 0, count = 0;  // first pixel, pixels
};

Station make_station(const ScanCurve& curve, const PixelModel& pixels, std::int32_t m, int places) {
  Station station;
  const std::int32_t tau = m * (1 << 16) - curve.m0;
  const std::int32_t share = curve.share_at(tau);
  const std::int32_t u = curve.place_at(tau, share);
  const std::int32_t wedge = curve.wedge + ScanCurve::scaled(curve.wedge_gain, share, 20);
  const Reach reach = reach_at(pixels, curve.curvature, wedge);
  const bool white_ahead = curve.normal > 0;
  const std::int32_t begin = (u - (white_ahead ? reach.outside : reach.inside) + kOne16 - 1) >> 16;
  const std::int32_t last = (u + (white_ahead ? reach.inside : reach.outside)) >> 16;
  if (begin < 0 || last >= places || last - begin >= kMaxWindow || last - begin < 2) return station;
  station.place = begin;
  station.count = last - begin + 1;
  station.model.e = (begin * (1 << 16) - u + 8) >> 4;
  const auto along = [&](std::int32_t gain) { return ScanCurve::scaled(gain, share, 20); };
  station.model.linear = pixels.linear[0] + along(pixels.linear[1] + along(pixels.linear[2]));
  station.model.x0 = pixels.x0 + along(pixels.x0_gain);
  station.model.pulse = pixels.pulse == 0 ? 0 : pixels.pulse + along(pixels.pulse_gain);
  return station;
}

}  // namespace

void measure_segment(const ImageView& image, const OutlinePiece& piece, const OutlineVertex& a,
                     const OutlineVertex& b, const OutlineMiddle& middle, const SegmentModel& model,
                     SegmentSums& sums) {
  ScanCurve curve;
  PixelModel pixels;
  if (!a.visible || !b.visible || !make_scan_curve(a, b, curve)) return;
  if (!make_pixel_model(piece, a, b, middle, model, curve, pixels, sums.sigma_px)) return;
  const int lines = curve.rows ? image.height : image.width;
  const int places = curve.rows ? image.width : image.height;
  const int step = curve.rows ? 1 : image.stride;
  std::int32_t first = (curve.m0 + kOne16 - 1) >> 16;
  std::int32_t end = (curve.m0 + curve.length + kOne16 - 1) >> 16;
  if (first < 0) first = 0;
  first = (first + model.stride - 1) & -model.stride;
  if (end > lines) end = lines;
  for (std::int32_t m = first; m < end; m += model.stride) {  // at most the image's side
    const Station station = make_station(curve, pixels, m, places);
    if (station.count == 0) continue;
    sums.looked_at += station.count;
    const std::uint8_t* start = curve.rows ? image.pixels + m * image.stride + station.place
                                           : image.pixels + station.place * image.stride + m;
    const StationSums here =
        measure_station(pixels, {start, step, station.count, image.polarity_mask}, station.model);
    if (here.pixels < 2 << 4) continue;  // all at the scale's end
    const std::int32_t weight = robust_weight(here, model);
    ++sums.stations;
    if (weight < kFullWeight / 4) ++sums.rejected;
    add_station(here, weight, sums);
  }
}

}  // namespace berth
