#include "pose/outline_edges.hpp"

#include "fixed/wide.hpp"
#include "pose/outline_segment.hpp"

namespace berth {
namespace {

constexpr std::int32_t kOne16 = 1 << 16;
constexpr int kMostBatched = 30;                // pixels that are summed at once
constexpr int kBatchPixels = kMostBatched + 2;  // and a lone one's partner

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

// Sums over a batch of stations; 32 bits hold them: 30 pixels, |r| <= 2^12.1 once censored, P and
// p <= 2^13.
struct BatchSums {
  std::int32_t slope_residual, slope_slope, blur_residual, blur_blur;
  std::int32_t slope, slope_step, step, step_step, blur, blur_step;
  std::int32_t residual, step_residual, square;
  std::int32_t pixels;  // sum of q, Q<4>
};

// What a segment's stations have in common, in formats whose products are the upper word: shares s
// of its length are Q<30>, gains over it are multiplied by 4.
struct StationCourse {
  std::int32_t first, second, third;  // of u in s: Q<25>, Q<27>, Q<29>
  std::int32_t u0, m0;                // px Q<16>
  std::int32_t behind, ahead;         // reach along the scan line, px Q<16>
  bool is_hollow_ahead;
  std::int32_t wedge, wedge_gain, least_wedge;  // |n_u| - |n_m|, Q<16>; what a full reach takes
  std::uint32_t per_curvature;                  // px Q<16>
  std::int32_t x0, x0_gain, pulse, pulse_gain;  // Q<12>
  std::int32_t linear[3];                       // Q<14>, Q<16>, Q<18>
  std::int32_t quadratic, cubic;                // Q<14>
};

// A station: its pixels, where the first one lies from the crossing, Q<12> px, and its own share of
// the model.
struct Station {
  int place, count;
  std::int32_t e, linear, x0, pulse;  // linear: Q<14>
};

// x + kProfileReach along a run of pixels by its differences, Q<24>: the cubic
// x0 + linear e + quadratic e^2 + cubic e^3 at e, e + 1, ... to 2^-16 over 25 pixels.
struct PlaceSteps {
  std::uint32_t y, first, second, third;

  PlaceSteps(const StationCourse& course, const Station& station) {
    constexpr std::int32_t kOne = 1 << 12;
    const std::int32_t e = station.e;                                           // |e| < 26 px
    const std::int32_t square = multiply_high(e * (1 << 10), e * (1 << 10));    // Q<12>
    const std::int32_t cube = multiply_high(square * (1 << 8), e * (1 << 12));  // Q<12>
    constexpr std::uint32_t kHalf = 1u << 11;  // x is rounded to Q<12>
    const auto start = static_cast<std::uint32_t>(station.x0 + kProfileReach * kOne);
    y = (start << 12) + kHalf +
        static_cast<std::uint32_t>((std::int64_t{station.linear} * e +
                                    std::int64_t{course.quadratic} * square +
                                    std::int64_t{course.cubic} * cube) >>
                                   2);
    const auto bent =
        static_cast<std::uint32_t>((std::int64_t{course.quadratic} * (2 * e + kOne) +
                                    std::int64_t{course.cubic} * (3 * (square + e) + kOne)) >>
                                   2);
    first = (static_cast<std::uint32_t>(station.linear) << 10) + bent;
    second = (static_cast<std::uint32_t>(course.quadratic) << 11) +
             static_cast<std::uint32_t>((course.cubic * (6 * (e + kOne))) >> 2);
    third = static_cast<std::uint32_t>(course.cubic * (6 << 10));
  }
  void advance() {
    y += first;
    first += second;
    second += third;
  }
};

// What the pixels of a batch should show, in pairs; a lone last one has zeros beside it. Q<13>;
// residuals Q<4>.
struct Window {
  alignas(4) std::int16_t slope[kBatchPixels], bulge[kBatchPixels], step[kBatchPixels];
  alignas(4) std::int16_t residual[kBatchPixels];
};

// Stations whose pixels are summed and weighed together.
struct Batch {
  Window window;
  std::int16_t shares[kBatchPixels];  // q of each pixel, where levels are censored
  int pixels = 0, stations = 0;
  bool is_censored = false;
};

constexpr int kHalf = 1 << (kProfileFraction - 1);

// P, p and, where asked for, h of each pixel, from place `at` on. An opposite edge changes nothing
// where it is more than kProfileReach away on its white side, which most pixels are.
template <bool kWithBulge, bool kWithPulse>
void fill_shape(const PixelModel& model, const StationCourse& course, const Station& station,
                int at, Window& window) {
  constexpr std::uint32_t kEnd = (2u * kProfileReach) << 24, kFar = (1u << 31) - kEnd;
  PlaceSteps place(course, station);
  const std::uint32_t turned = static_cast<std::uint32_t>(station.pulse + 2 * kProfileReach * 4096)
                               << 12;
  std::int16_t *step = window.step + at, *const end = step + station.count;
  std::int16_t *slope = window.slope + at, *bulge = window.bulge + at;
  for (; step < end; place.advance()) {  // at most kMaxWindow
    ProfileValue p = look_up_from_start(*model.profile, place.y);
    const std::int32_t x = (static_cast<std::int32_t>(place.y) >> 12) - kProfileReach * 4096;
    std::int32_t h = kWithBulge ? (p.slope * x) >> 12 : 0;
    const std::uint32_t opposite = turned - place.y;
    if (kWithPulse && opposite - kEnd >= kFar) {
      const ProfileValue other = look_up_from_start(*model.profile, opposite);
      p.step += other.step - (1 << kProfileFraction);
      p.slope -= other.slope;
      if (kWithBulge) h += (other.slope * (station.pulse - x)) >> 12;
    }
    *step++ = static_cast<std::int16_t>(p.step);
    *slope++ = static_cast<std::int16_t>(p.slope);
    if (kWithBulge) *bulge++ = static_cast<std::int16_t>(h);
  }
}

// The same with skew.
[[gnu::noinline]] void fill_skewed_shape(const PixelModel& model, const StationCourse& course,
                                         const Station& station, int at, Window& window) {
  PlaceSteps place(course, station);
  const std::uint32_t turned = static_cast<std::uint32_t>(station.pulse + 2 * kProfileReach * 4096)
                               << 12;
  for (int i = at; i < at + station.count; ++i, place.advance()) {  // at most kMaxWindow
    ProfileValue p = look_up_from_start(*model.profile, place.y);
    const std::int32_t x = (static_cast<std::int32_t>(place.y) >> 12) - kProfileReach * 4096;
    std::int32_t h = (p.slope * x) >> 12;
    p.step += (model.skew * (p.slope - ((h * x) >> 12)) + kHalf) >> kProfileFraction;
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

// A segment's pixels in the image, along a scan line.
struct Run {
  const std::uint8_t* start;
  int stride;
  std::uint8_t polarity;
};

// Residuals; false where some level lies so near to an end of the scale that it is censored.
bool fill_residuals(const PixelModel& model, const Run& run, const Station& station, int at,
                    Window& window) {
  std::int32_t black = model.black + ((station.e * model.black_per_px) >> 12);
  std::int32_t contrast = model.contrast + ((station.e * model.contrast_per_px) >> 12);
  const std::int32_t black_per_px = model.black_per_px, contrast_per_px = model.contrast_per_px;
  const std::int32_t low = model.low;
  const auto room = static_cast<std::uint32_t>(model.high - low);
  const std::int16_t *step = window.step + at, *const end = step + station.count;
  const int polarity = run.polarity, stride = run.stride;
  std::int16_t* residual = window.residual + at;
  const std::uint8_t* pixel = run.start;
  for (; step < end; pixel += stride) {
    const std::int32_t level = black + ((contrast * *step++ + kHalf) >> kProfileFraction);  // Q<8>
    if (static_cast<std::uint32_t>(level - low) > room) return false;
    *residual++ =
        static_cast<std::int16_t>(((*pixel ^ polarity) << kLevelFraction) - ((level + 8) >> 4));
    black += black_per_px;
    contrast += contrast_per_px;
  }
  return true;
}

// Residuals to the means of clipped levels; `shares` gets q of each pixel, Q<13>.
[[gnu::noinline]] void fill_censored_residuals(const PixelModel& model, const Run& run,
                                               const Station& station, Batch& batch) {
  std::int32_t black = model.black + ((station.e * model.black_per_px) >> 12);
  std::int32_t contrast = model.contrast + ((station.e * model.contrast_per_px) >> 12);
  const std::uint8_t* pixel = run.start;
  for (int i = batch.pixels; i < batch.pixels + station.count; ++i, pixel += run.stride) {
    std::int32_t level = black + ((contrast * batch.window.step[i] + kHalf) >> kProfileFraction);
    batch.shares[i] = 1 << kProfileFraction;
    if (level < model.low || level > model.high) {
      const Clipped clipped = clip(model, level);
      level = clipped.level;
      batch.shares[i] = static_cast<std::int16_t>(clipped.share);
    }
    batch.window.residual[i] =
        static_cast<std::int16_t>(((*pixel ^ run.polarity) << kLevelFraction) - ((level + 8) >> 4));
    black += model.black_per_px;
    contrast += model.contrast_per_px;
  }
}

// A station more; false where it needs a batch that is censored.
[[gnu::noinline]] bool fill_station(const PixelModel& model, const StationCourse& course,
                                    const Run& run, const Station& station, bool with_blur,
                                    Batch& batch) {
  if (model.skew != 0) {
    fill_skewed_shape(model, course, station, batch.pixels, batch.window);
  } else {
    const auto fill = station.pulse != 0
                          ? (with_blur ? fill_shape<true, true> : fill_shape<false, true>)
                          : (with_blur ? fill_shape<true, false> : fill_shape<false, false>);
    fill(model, course, station, batch.pixels, batch.window);
  }
  if (batch.is_censored) {
    fill_censored_residuals(model, run, station, batch);
    return true;
  }
  return fill_residuals(model, run, station, batch.pixels, batch.window);
}

// q times a factor of the window; both Q<13>.
void censor(const std::int16_t* factor, const std::int16_t* shares, int count, std::int16_t* out) {
  for (int i = 0; i < count; ++i) {
    out[i] = static_cast<std::int16_t>((factor[i] * shares[i] + kHalf) >> kProfileFraction);
  }
}

// Sums of products; a factor that is squared goes with its weighed self. In passes, so that the
// sums of each stay in registers.
inline void sum_window(const Window& window, const Window& weighed, int count, bool with_blur,
                       BatchSums& s) {
  constexpr Pair kOnes = both(1);
  {
    std::int32_t pr = 0, mr = 0, pp = 0, pm = 0, p1 = 0, mm = 0, m1 = 0;
    for (int i = 0; i < count; i += 2) {
      const Pair p = load(&window.slope[i]), m = load(&window.step[i]);
      const Pair r = load(&window.residual[i]);
      const Pair wp = load(&weighed.slope[i]), wm = load(&weighed.step[i]);
      pr = add_products(p, r, pr);
      mr = add_products(m, r, mr);
      pp = add_products(wp, p, pp);
      pm = add_products(wp, m, pm);
      p1 = add_products(wp, kOnes, p1);
      mm = add_products(wm, m, mm);
      m1 = add_products(wm, kOnes, m1);
    }
    s.slope_residual = pr, s.step_residual = mr, s.slope_slope = pp, s.slope = p1, s.step = m1;
    s.slope_step = (pm + kHalf) >> kProfileFraction;
    s.step_step = (mm + kHalf) >> kProfileFraction;
  }
  std::int32_t rr = 0, r1 = 0;
  if (!with_blur) {
    for (int i = 0; i < count; i += 2) {
      const Pair r = load(&window.residual[i]);
      rr = add_products(r, r, rr);
      r1 = add_products(r, kOnes, r1);
    }
  } else {
    std::int32_t hr = 0, hh = 0, hm = 0, h1 = 0;
    for (int i = 0; i < count; i += 2) {
      const Pair h = load(&window.bulge[i]), m = load(&window.step[i]);
      const Pair r = load(&window.residual[i]);
      const Pair wh = load(&weighed.bulge[i]);
      hr = add_products(h, r, hr);
      hh = add_products(wh, h, hh);
      hm = add_products(wh, m, hm);
      h1 = add_products(wh, kOnes, h1);
      rr = add_products(r, r, rr);
      r1 = add_products(r, kOnes, r1);
    }
    s.blur_residual = hr, s.blur_blur = hh, s.blur = h1;
    s.blur_step = (hm + kHalf) >> kProfileFraction;
  }
  s.square = rr, s.residual = r1;
}

void clear_behind(Window& window, int i) {
  window.slope[i] = window.bulge[i] = window.step[i] = window.residual[i] = 0;
}

[[gnu::noinline]] void sum_censored(const Batch& batch, bool with_blur, BatchSums& s) {
  const Window& window = batch.window;
  Window weighed;
  censor(window.slope, batch.shares, batch.pixels, weighed.slope);
  censor(window.step, batch.shares, batch.pixels, weighed.step);
  if (with_blur) censor(window.bulge, batch.shares, batch.pixels, weighed.bulge);
  clear_behind(weighed, batch.pixels);
  sum_window(window, weighed, batch.pixels, with_blur, s);
  s.pixels = 0;
  for (int i = 0; i < batch.pixels; ++i) s.pixels += batch.shares[i];
  s.pixels = (s.pixels + (1 << 8)) >> (kProfileFraction - 4);
}

// What batches are judged by. Up to 1.6 % of the contrast may be the profile's own error.
struct Judge {
  std::int32_t ordinary = 0;  // mean square, DN^2 Q<8>, at most 2^22: the residuals' scale
  std::int32_t small_square;  // of the profile's error, below 2^14
  bool judge_shift;

  explicit Judge(const SegmentModel& model) : judge_shift(model.judge_shift) {
    constexpr std::int32_t kMost = 1 << 22;
    ordinary = model.ordinary_q8 < kMost ? model.ordinary_q8 : kMost;
    const std::int32_t small = model.contrast / 64;  // Q<4>, at most 127
    small_square = small * small;
  }
};

// Full weight up to four times the ordinary mean square, then falling with its square.
std::int32_t robust_weight(const BatchSums& s, int stations, const Judge& judge) {
  if (judge.ordinary == 0) return kFullWeight;
  const std::int32_t limit =
      ((judge.ordinary + judge.small_square) * s.pixels) >> 2;  // 4 times, Q<4>
  std::int32_t weight = kFullWeight;
  if (s.square > limit) {
    const auto ratio = static_cast<std::int32_t>((std::int64_t{limit} << 4) / s.square);  // < 16
    weight = (ratio * ratio) >> 4;
  }
  if (judge.judge_shift) {
    // (p r)^2 / (p p) is the square that a shift explains: above 12 sigma^2 a station, 2^29 at
    // most, it is no noise, and above (C / 32)^2 p p, a shift by 0.03 of the blur, no error of the
    // profile.
    const std::int64_t shift = std::int64_t{s.slope_residual} * s.slope_residual;  // Q<34>
    const std::int32_t profile = judge.small_square * (s.slope_slope >> 13);       // below 2^31
    const std::int64_t bound =
        std::int64_t{12 * stations * judge.ordinary + (profile >> 11)} * s.slope_slope;  // Q<34>
    if (shift > 4 * bound) return 0;
    if (shift > bound) weight /= 4;
  }
  return weight;
}

// Adds what the batch holds.
[[gnu::noinline]] void add_batch(const Judge& judge, bool with_blur, Batch& batch,
                                 SegmentSums& sums) {
  clear_behind(batch.window, batch.pixels);
  BatchSums s;
  if (batch.is_censored) {
    sum_censored(batch, with_blur, s);
    if (s.pixels < 2 << 4) return;  // all at the scale's end
  } else {
    sum_window(batch.window, batch.window, batch.pixels, with_blur, s);
    s.pixels = batch.pixels << 4;
  }
  const std::int32_t weight = robust_weight(s, batch.stations, judge);
  sums.stations += batch.stations;
  if (weight < kFullWeight / 4) sums.rejected += batch.stations;
  add_product(sums.slope_residual, s.slope_residual, weight);
  add_product(sums.slope_slope, s.slope_slope, weight);
  add_product(sums.slope, s.slope, weight);
  add_product(sums.slope_step, s.slope_step, weight);
  add_product(sums.step, s.step, weight);
  add_product(sums.step_step, s.step_step, weight);
  add_product(sums.residual, s.residual, weight);
  add_product(sums.step_residual, s.step_residual, weight);
  add_product(sums.square, s.square, weight);
  sums.pixels += (weight * s.pixels) >> 4;
  if (!with_blur) return;
  add_product(sums.blur_residual, s.blur_residual, weight);
  add_product(sums.blur_blur, s.blur_blur, weight);
  add_product(sums.blur, s.blur, weight);
  add_product(sums.blur_step, s.blur_step, weight);
}

void close_batch(const Judge& judge, bool with_blur, Batch& batch, SegmentSums& sums) {
  if (batch.stations == 0) return;
  add_batch(judge, with_blur, batch, sums);
  batch.stations = batch.pixels = 0;
}

// False where the curve is none of an outline within the image.
bool make_course(const ScanCurve& curve, const PixelModel& pixels, StationCourse& course) {
  constexpr std::int32_t kMostBend = 7 << 20, kLongest = 256 << 16, kMostCubic = 3300;
  const auto is_bent = [](std::int32_t v) { return v >= kMostBend || v <= -kMostBend; };
  if (is_bent(curve.first) || is_bent(curve.second) || is_bent(2 * curve.third)) return false;
  if (curve.length >= kLongest) return false;
  course.first = curve.first * (1 << 5);
  course.second = curve.second * (1 << 7);
  course.third = curve.third * (1 << 9);
  course.u0 = curve.u0;
  course.m0 = curve.m0;
  const bool white_ahead = curve.normal > 0, is_hollow = curve.curvature > 0;
  course.ahead = white_ahead ? pixels.inside : pixels.outside;
  course.behind = white_ahead ? pixels.outside : pixels.inside;
  course.is_hollow_ahead = white_ahead == is_hollow;
  // Where |n_u| - |n_m| is less, the reach is shortened.
  const std::int32_t bend = is_hollow ? curve.curvature : -curve.curvature;
  const std::int32_t hollow = course.is_hollow_ahead ? course.ahead : course.behind;
  course.least_wedge = bend == 0 ? INT32_MIN : saturate32((std::int64_t{hollow} * bend >> 16) + 1);
  course.per_curvature = pixels.per_curvature;
  course.wedge = curve.wedge;
  course.wedge_gain = curve.wedge_gain * 4;
  course.x0 = pixels.x0;
  course.x0_gain = pixels.x0_gain * 4;
  course.pulse = pixels.pulse;
  course.pulse_gain = pixels.pulse_gain * 4;
  course.linear[0] = pixels.linear[0];
  course.linear[1] = pixels.linear[1] * 4;
  course.linear[2] = pixels.linear[2] * 16;
  course.quadratic = pixels.quadratic;
  course.cubic = pixels.cubic < kMostCubic ? pixels.cubic : kMostCubic;
  if (course.cubic < -kMostCubic) course.cubic = -kMostCubic;
  return true;
}

// Rows and columns share the inside of a small circle at its diagonals, so that no pixel is used
// twice: from the edge to there it is (|n_u| - |n_m|) / kappa.
std::int32_t shortened(std::uint32_t per_curvature, std::int32_t wedge, std::int32_t reach) {
  const std::uint64_t room =
      (static_cast<std::uint64_t>(wedge > 0 ? wedge : 0) * per_curvature) >> 16;
  return room < static_cast<std::uint32_t>(reach) ? static_cast<std::int32_t>(room) : reach;
}

// The station on scan line m; false where there is nothing to look at.
bool make_station(const StationCourse& course, std::int32_t m, std::int32_t share, int places,
                  Station& station) {
  const auto along = [&](std::int32_t four_gains) { return multiply_high(four_gains, share); };
  const std::int32_t slope = course.first + along(course.second + along(course.third));
  const std::int32_t tau = (m * (1 << 16) - course.m0) * (1 << 7);  // below 256 px, Q<23>
  const std::int32_t u = course.u0 + multiply_high(tau, slope);
  std::int32_t behind = course.behind, ahead = course.ahead;
  const std::int32_t wedge = course.wedge + along(course.wedge_gain);
  if (wedge < course.least_wedge) {
    if (course.is_hollow_ahead) {
      ahead = shortened(course.per_curvature, wedge, ahead);
    } else {
      behind = shortened(course.per_curvature, wedge, behind);
    }
  }
  const std::int32_t begin = (u - behind + kOne16 - 1) >> 16;
  const std::int32_t last = (u + ahead) >> 16;
  if (begin < 0 || last >= places || last - begin >= kMaxWindow || last - begin < 2) return false;
  station.place = begin;
  station.count = last - begin + 1;
  station.e = (begin * (1 << 16) - u + 8) >> 4;
  station.linear = course.linear[0] + along(course.linear[1] + along(course.linear[2]));
  station.x0 = course.x0 + along(course.x0_gain);
  station.pulse = course.pulse == 0 ? 0 : course.pulse + along(course.pulse_gain);
  return true;
}

}  // namespace

void measure_segment(const ImageView& image, const OutlinePiece& piece, const OutlineVertex& a,
                     const OutlineVertex& b, const OutlineMiddle& middle, const SegmentModel& model,
                     SegmentSums& sums) {
  ScanCurve curve;
  PixelModel pixels;
  if (!a.visible || !b.visible || !make_scan_curve(a, b, curve)) return;
  if (!make_pixel_model(piece, a, b, middle, model, curve, pixels, sums.sigma_px)) return;
  StationCourse course;
  if (!make_course(curve, pixels, course)) return;
  const Judge judge(model);
  const int lines = curve.rows ? image.height : image.width;
  const int places = curve.rows ? image.width : image.height;
  const int step = curve.rows ? 1 : image.stride;
  std::int32_t first = (curve.m0 + kOne16 - 1) >> 16;
  std::int32_t end = (curve.m0 + curve.length + kOne16 - 1) >> 16;
  if (first < 0) first = 0;
  first = (first + model.stride - 1) & -model.stride;
  if (end > lines) end = lines;
  // Share of the length: below 1 by its rounding at least; beyond the end it may wrap.
  auto share = static_cast<std::uint32_t>(
      (std::int64_t{first * (1 << 16) - curve.m0} * curve.per_length) >> 12);
  const auto share_step =
      static_cast<std::uint32_t>((std::int64_t{model.stride} * curve.per_length) << 4);
  // Four batches at least, so that one that is disturbed is not the whole segment.
  const int quarter = (end - first) / (4 * model.stride);
  const int together = quarter > 1 ? quarter : 1;
  Batch batch;
  for (std::int32_t m = first; m < end; m += model.stride, share += share_step) {
    Station station;
    if (!make_station(course, m, static_cast<std::int32_t>(share), places, station)) continue;
    if (batch.stations == together || batch.pixels + station.count > kMostBatched) {
      close_batch(judge, model.with_blur, batch, sums);
    }
    const Run run{curve.rows ? image.pixels + m * image.stride + station.place
                             : image.pixels + station.place * image.stride + m,
                  step, image.polarity_mask};
    if (!fill_station(pixels, course, run, station, model.with_blur, batch)) {
      close_batch(judge, model.with_blur, batch, sums);
      batch.is_censored = true;
      fill_station(pixels, course, run, station, model.with_blur, batch);
    }
    batch.pixels += station.count;
    ++batch.stations;
    sums.pixel_work += batch.is_censored ? 2 * station.count : station.count;
  }
  close_batch(judge, model.with_blur, batch, sums);
}

}  // namespace berth
