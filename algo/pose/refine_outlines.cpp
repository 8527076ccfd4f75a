#include <new>

#include "fixed/linear.hpp"
#include "fixed/roots.hpp"
#include "pose/outline.hpp"

namespace berth {
namespace {

// Mean squares of the outlines' shift, px^2 Q<20>.
constexpr std::int64_t kNearSquare = q<20>(0.0025).raw();  // 0.05 px: for outliers to show
constexpr std::int64_t kKeptSquare = q<20>(0.01).raw();    // 0.1 px: vertices are shifted

// Every stride-th scan line and long segments while the pose is still coarse.
struct Round {
  std::int32_t stride;
  bool is_coarse;
  bool judge_shift;
};
constexpr int kMostCoarseRounds = 6, kMostFineRounds = 3, kSoon = 2;
// From afar every eighth line would leave a dot's segments without any.
constexpr Round kFirstNear = {8, true, false};
constexpr std::int64_t kNearOutline = 1200;  // px of all outlines
constexpr Round kCoarseRound = {4, true, false}, kJudgedRound = {2, true, true};
constexpr Round kFineRound = {1, false, true};
constexpr Round kSizesRound = {2, false, false};
constexpr std::int64_t kMaxStep = q<30>(0.1).raw();  // rad, lever
constexpr std::int64_t kMaxOffsetStep = q<30>(0.02).raw();
constexpr std::int32_t kMaxEdgeOffset = q<16>(0.8).raw();
// Work of a round, a segment, a station, a pixel, in instructions of the Cortex-M7.
constexpr std::uint32_t kStepsPerRound = 250000, kStepsPerSegment = 6000;
constexpr std::uint32_t kStepsForSizes = 100000;
constexpr std::uint32_t kStepsPerStation = 450, kStepsPerPixel = 66;
constexpr std::int64_t kMostVariance = std::int64_t{1} << 32;
constexpr std::int64_t kMostGain = std::int64_t{1} << 50;
constexpr int kFewestSectors = 6;
constexpr std::int64_t kLeastStart = q<16>(0.4).raw();  // px^2: sharper blur reaches too few pixels
constexpr Px kReachPad = q<16>(0.5);

std::int64_t clamp(std::int64_t v, std::int64_t limit) {
  return v > limit ? limit : (v < -limit ? -limit : v);
}

struct State {
  const OutlineInput& input;
  OutlineWorkspace& workspace;
  RigidTransform pose;
  ImageBlur blur;
  EdgeOffset edge_offset;
  std::int32_t ordinary_q8 = 0;  // mean squared residual of most sectors, DN^2
  SpdSystem<kOutlineUnknowns> system;
  std::uint32_t steps = 0;        // work so far
  std::int32_t explained_q8 = 0;  // what the last step takes off the mean square
  OutlineStep last{};             // the last step
  std::int64_t shift_square = 0;  // mean square of how far it moved the outlines, px^2 Q<20>
  bool is_blur_settled = false;
  bool is_late = false;  // a round that was needed did not fit
  std::int64_t blur_growth = 0;
  Px traced_reach{0};  // for which the workspace's long segments were projected; 0: none
};

int sectors_of(const State& state) { return sector_count(state.input.target); }

// 3 sigma of the widest blur, for margins at occlusions.
Px reach_of(const ImageBlur& blur) {
  const std::int64_t floor = blur_floor(blur).raw();
  const std::int64_t largest = std::int64_t{blur.xx.raw()} + blur.yy.raw() - floor;
  const std::int64_t sigma = isqrt(static_cast<std::uint64_t>(largest) << 16);
  return Px::from_wide(3 * sigma) + kReachPad;
}

// From sigma on the plate, where tilt foreshortens one direction. The profiles that saw it
// interpolate between pixels, which adds a sixth of a pixel squared.
ImageBlur round_start(const OutlineInput& input) {
  constexpr std::int64_t kMost = 16 << 16;  // px Q<16>
  const std::int64_t front = clamp(std::int64_t{input.blur_mm.raw()} * input.camera.fx.raw() /
                                       input.start.translation_mm[2].raw(),
                                   kMost);
  constexpr std::int64_t kOne = std::int64_t{1} << 30;
  const std::int64_t seen = (kOne + abs(input.start.rotation(2, 2)).raw()) / 2;
  const std::int64_t sigma = shift_round(front * seen, 30);
  const std::int64_t variance = shift_round(sigma * sigma, 16) - (1 << 16) / 6;
  return round_blur(variance > kLeastStart ? variance : kLeastStart);
}

// The last frame's blur, which has its direction, unless it has changed by half.
ImageBlur start_blur(const OutlineInput& input) {
  if (input.blur_mm.raw() <= 0) return {};
  const ImageBlur round = round_start(input), &last = input.last_blur;
  const std::int64_t seen = 2 * std::int64_t{round.xx.raw()};
  const std::int64_t known = std::int64_t{last.xx.raw()} + last.yy.raw();
  return 3 * known > 2 * seen && 2 * known < 3 * seen ? last : round;
}

LayoutScale layout_scale(const State& state, Px reach) {
  LayoutScale scale;
  const Mm z = state.pose.translation_mm[2];
  scale.px_per_mm = Q<16>::saturated((std::int64_t{state.input.camera.fx.raw()} << 18) / z.raw());
  if (scale.px_per_mm.raw() < 64) scale.px_per_mm = Q<16>::from_raw(64);
  scale.corner_mm = Mm::saturated((std::int64_t{reach.raw()} << 18) / scale.px_per_mm.raw());
  return scale;
}

Mm halfway(Mm a, Mm b) { return Mm::from_wide((std::int64_t{a.raw()} + b.raw()) / 2); }

// Slope of a level in the image, DN per px Q<8>, from its slope across the marker's plane.
void set_slope(const std::int32_t per_mm[2], const Q<16> place_by_px[2][2], std::int32_t slope[2]) {
  for (int axis = 0; axis < 2; ++axis) {
    slope[axis] = saturate32(shift_round(std::int64_t{per_mm[0]} * place_by_px[0][axis].raw() +
                                             std::int64_t{per_mm[1]} * place_by_px[1][axis].raw(),
                                         24));
  }
}

// How the sector's plane lies in the image: as the first round sees it, which is near enough for
// slopes of the light.
void place_sector(State& state, const OutlineView& view, const OutlineSector& sector, int k) {
  const std::int8_t raised = sector.pieces[0].raised;
  const Mm z = raised >= 0 ? state.input.target.dots[raised].center_mm[2] : Mm(0);
  auto& place_by_px = state.workspace.place_by_px[k];
  if (!place_by_pixel(view, Vec3Mm(sector.center_x, sector.center_y, z), place_by_px)) {
    for (auto& row : place_by_px) row[0] = row[1] = Q<16>(0);
  }
}

SectorLight light_sector(const State& state, const OutlineView& view, const OutlineSector& sector,
                         int k, SegmentModel& model) {
  const Unit nearer = sector.pieces[0].raised >= 0 ? view.shade_scale_minus_one : Unit(0);
  const SectorLight light = light_of(state.workspace.levels, k, nearer);
  set_slope(light.black_slope, state.workspace.place_by_px[k], model.black_slope);
  set_slope(light.contrast_slope, state.workspace.place_by_px[k], model.contrast_slope);
  return light;
}

// The vertices of the pieces of a round: projected, or, of long segments once they hardly move,
// those of the round before shifted along their normals.
class Tracer {
 public:
  Tracer(State& state, const OutlineView& view, const Round& round)
      : state_(state), walk_(view), keeps_(round.is_coarse) {
    // What is hidden was judged for the reach of then: a smaller one leaves it on the safe side.
    const std::int32_t wider = (view.reach_px - state.traced_reach).raw();
    shifts_ = keeps_ && state.traced_reach.raw() > 0 && state.shift_square < kKeptSquare &&
              wider < kMostWider;
    if (!shifts_ && keeps_) state.traced_reach = view.reach_px;
  }
  bool shifts() const { return shifts_; }
  bool is_last() const { return !keeps_; }
  /// Piece i of sector k.
  void begin(const OutlinePiece& piece, int k, int i) {
    next_ = coarse_vertex(state_.input.target, k, i);
    if (!shifts_) walk_.begin(piece);
  }
  OutlineVertex next() {
    if (!keeps_) return walk_.next();
    OutlineVertex& kept = state_.workspace.traced[next_++];
    if (!shifts_) {
      kept = walk_.next();
    } else if (kept.visible) {
      shift_along_normal(state_.last.pose, kept);
    }
    return kept;
  }

 private:
  static constexpr std::int32_t kMostWider = q<16>(0.5).raw();
  State& state_;
  OutlineWalk walk_;
  int next_ = 0;
  bool keeps_, shifts_;
};

void measure_piece(State& state, Tracer& tracer, const OutlinePiece& piece,
                   const SectorLight& light, SegmentModel& model) {
  OutlineWorkspace& ws = state.workspace;
  const int lever_log2 = lever_log2_of(state.input.target);
  OutlineVertex last = tracer.next();
  for (int i = 1; i <= piece.segments; ++i) {  // at most 32
    const OutlineVertex next = tracer.next();
    const LocalLevel level =
        level_at(light, halfway(last.place_x, next.place_x), halfway(last.place_y, next.place_y));
    model.black = level.black;
    model.contrast = level.contrast;
    if (level.contrast > 0 && last.visible && next.visible) {
      SegmentSums sums;
      const OutlineMiddle middle = middle_of(last, next);
      measure_segment(state.input.image, piece, last, next, middle, model, sums);
      state.steps += kStepsPerSegment +
                     static_cast<std::uint32_t>(sums.stations) * kStepsPerStation +
                     static_cast<std::uint32_t>(sums.looked_at) * kStepsPerPixel;
      const std::int32_t gain = tracer.is_last() ? size_gain(piece, last, next, lever_log2) : 0;
      add_segment(sums, middle, level.contrast, {piece.size, gain}, ws.sector);
      if (model.judge_shift) {
        if (piece.size == OutlineSize::kDotRadius) {
          add_to_slope_test(sums, middle, ws.sector.light);
        }
        if (is_disturbed(sums, level.contrast, state.ordinary_q8)) ++ws.sector.disturbed;
      }
      if (model.with_blur) add_blur(sums, middle, level.contrast, ws.sector_blur);
    }
    last = next;
  }
}

// Whether the sector's residuals are 1.6 times the ordinary ones and beyond 2 % of its contrast.
bool is_misfit(const SectorSums& sums, const SectorLevel& level, std::int32_t ordinary_q8) {
  const std::int64_t mean = (sums.square - sums.explained) / sums.pixels;  // DN^2 Q<8>
  const std::int64_t small = level.contrast / 50;                          // DN Q<4>
  return 5 * mean > 8 * std::int64_t{ordinary_q8} && mean - ordinary_q8 > small * small;
}

// Noise where the scale ends: the sensor's, and what rounding adds, one sigma, Q<8>.
std::int32_t scale_noise(std::int32_t noise_q8) {
  constexpr std::int32_t kUnknown = 2 << 8, kRounding = (1 << 16) / 12, kMost = 1 << 12;
  if (noise_q8 <= 0 || noise_q8 > kMost) return kUnknown;
  return static_cast<std::int32_t>(isqrt(
      static_cast<std::uint64_t>(noise_q8) * static_cast<std::uint64_t>(noise_q8) + kRounding));
}

// So near to an end of the scale that pixels of this level are censored.
bool is_censored(const State& state, const SectorLevel& level) {
  constexpr std::int32_t kEnd = kScaleEnd >> (8 - kLevelFraction);
  const std::int32_t near = (5 * scale_noise(state.input.noise_q8) / 2) >> (8 - kLevelFraction);
  return level.black < near || level.black + level.contrast > kEnd - near;
}

// False where the sector does not show its marker in even light.
bool take_sector(const State& state, const Round& round, bool with_blur, int k) {
  OutlineWorkspace& ws = state.workspace;
  SectorLevel& level = ws.levels.sectors[k];
  const LevelBasis basis = level_basis(ws.sector);
  if (!basis.valid || !level.trusted || ws.sector.disturbed > 0) return false;
  if (round.judge_shift && k < state.input.target.dot_count &&
      is_lit_unevenly(ws.sector.light, level.contrast, state.ordinary_q8)) {
    return false;
  }
  if (!shows_marker(ws.levels, k)) return false;
  eliminate_levels(basis, ws.sector);
  if (is_censored(state, level)) ws.sector.explained = 0;
  if (round.judge_shift && is_misfit(ws.sector, level, state.ordinary_q8)) return false;
  ws.used[ws.used_count++] = ws.sector;
  if (with_blur) add_sector_blur(ws.sector_blur, basis, ws.blur);
  return true;
}

void measure_all(State& state, const Round& round) {
  OutlineWorkspace& ws = state.workspace;
  state.steps += kStepsPerRound;
  ws.blur = BlurNormal{};
  ws.used_count = 0;
  for (int k = 0; k < kMaxMarkers; ++k) ws.marker_stations[k] = ws.marker_rejected[k] = 0;
  SegmentModel model;
  model.blur = state.blur;
  model.blur_floor = blur_floor(state.blur);
  model.ordinary_q8 = state.ordinary_q8;
  model.judge_shift = round.judge_shift;
  model.with_blur = !state.is_blur_settled || round.is_coarse;
  model.edge_offset = state.edge_offset;
  model.noise_q8 = scale_noise(state.input.noise_q8);
  model.stride = round.stride;
  const Px reach = reach_of(state.blur);
  const OutlineView view =
      make_outline_view(state.input.camera, state.input.target, state.pose, reach);
  LayoutScale scale = layout_scale(state, reach);
  scale.is_coarse = round.is_coarse;
  Tracer tracer(state, view, round);
  for (int k = 0; k < sectors_of(state); ++k) {
    const OutlineSector sector = make_outline_sector(state.input.target, k, scale);
    SectorLevel& level = ws.levels.sectors[k];
    level.x = sector.center_x;
    level.y = sector.center_y;
    new (&ws.sector) SectorSums();
    ws.sector.size = sector.pieces[0].size;
    ws.sector_blur = SectorBlur{};
    if (round.is_coarse && !tracer.shifts()) place_sector(state, view, sector, k);
    const SectorLight light = light_sector(state, view, sector, k, model);
    for (int i = 0; i < sector.count; ++i) {
      tracer.begin(sector.pieces[i], k, i);
      measure_piece(state, tracer, sector.pieces[i], light, model);
    }
    update_sector_level(ws.sector, level);
    keep_share(ws.sector, ws.sector_blur, ws.shares[k]);
    const bool usable = take_sector(state, round, model.with_blur, k);
    ws.marker_stations[sector.marker] =
        static_cast<std::uint16_t>(ws.marker_stations[sector.marker] + ws.sector.stations);
    ws.marker_rejected[sector.marker] = static_cast<std::uint16_t>(
        ws.marker_rejected[sector.marker] + (usable ? ws.sector.rejected : ws.sector.stations));
  }
}

// R <- exp(omega) R by Cayley's map, orthogonal to rounding: with c = omega / 2
//   R' = R + 2 / (1 + c.c) (c x R + c x (c x R))
void rotate(RigidTransform& pose, const Unit omega[3]) {
  Unit c[3];
  std::int64_t square = 0;
  for (int i = 0; i < 3; ++i) {
    c[i] = Unit::from_raw(omega[i].raw() / 2);
    square += std::int64_t{c[i].raw()} * c[i].raw();
  }
  const Unit one_plus = Unit(1) + Unit::from_wide(shift_round(square, 30));
  const Unit factor = div<30>(Unit(1), one_plus);  // 1 / (1 + c.c)
  for (int col = 0; col < 3; ++col) {
    Unit r[3], a[3];
    for (int i = 0; i < 3; ++i) r[i] = pose.rotation(i, col);
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      a[i] = c[j] * r[k] - c[k] * r[j];
    }
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      const Unit change = factor * (a[i] + (c[j] * a[k] - c[k] * a[j]));
      pose.rotation(i, col) = r[i] + change + change;
    }
  }
}

constexpr int diagonal_term(int i) { return i * (i + 3) / 2; }

// Factors the equations; false where they determine no pose.
bool factor(State& state) {
  std::int64_t square[kOutlineUnknowns][kOutlineUnknowns];
  const std::int64_t* term = state.workspace.normal.matrix;
  for (int i = 0; i < kOutlineUnknowns; ++i) {
    for (int k = 0; k <= i; ++k) square[i][k] = *term++;
  }
  return state.system.factor(square);
}

// Edge offset: o within 0.3, as a prior in units of the noise; o / 16 is the unknown.
void add_offset_prior(const State& state, OutlineNormal& n) {
  const std::int64_t variance = n.pixels > 0 ? (n.square / n.pixels) + 1 : 1;  // Q<8>
  for (int k = 0; k < 3; ++k) {
    n.matrix[diagonal_term(6 + k)] += (variance * 2844) << 6;
    n.vector[6 + k] -=
        shift_round(((variance * 2844) * state.edge_offset.terms[k].raw()) / kOffsetScale, 7);
  }
}

// All sectors alike.
void sum_sectors(State& state) {
  OutlineWorkspace& ws = state.workspace;
  new (&ws.normal) OutlineNormal();
  for (int k = 0; k < ws.used_count; ++k) {
    add_sector(ws.used[k], kWholeSector, ws.normal);
    ws.normal.segments += ws.used[k].segments;
  }
  ws.normal.sectors = ws.used_count;
  add_offset_prior(state, ws.normal);
}

// What of them is too much: a sector of excess F weighs 1 / F.
void weigh_sectors(State& state, const std::int64_t (&step)[kOutlineUnknowns]) {
  OutlineWorkspace& ws = state.workspace;
  for (int k = 0; k < ws.used_count; ++k) {
    const SectorEquations& sector = ws.used[k];
    const std::int64_t excess = excess_q8(sector, gain_of_step(sector, step), state.ordinary_q8);
    const auto weight = static_cast<std::int32_t>((1 << 16) / excess);
    if (weight < kWholeSector) add_sector(sector, weight - kWholeSector, ws.normal);
  }
}

bool solve(State& state, std::int64_t (&x)[kOutlineUnknowns]) {
  return factor(state) && state.system.solve(state.workspace.normal.vector, x, 27);
}

// One Gauss-Newton step; false where the outline does not determine a pose.
bool step(State& state, const Round& round) {
  OutlineNormal& n = state.workspace.normal;
  std::int64_t x[kOutlineUnknowns];
  sum_sectors(state);
  if (!solve(state, x)) return false;
  if (round.judge_shift) {
    weigh_sectors(state, x);
    if (!solve(state, x)) return false;
  }
  // What the step takes off the sum of squares (Q<17> by Q<30>) to Q<12>, over the information,
  // Q<4>.
  std::int64_t gain = 0;
  for (int i = 0; i < kOutlineUnknowns; ++i) gain += mul_shift(n.vector[i], x[i], 17 + 30 - 12);
  n.explained += gain;
  state.explained_q8 = n.pixels > 0 ? saturate32(gain / n.pixels) : 0;
  state.shift_square = n.information > 0 ? (clamp(gain, kMostGain) * (1 << 12)) / n.information : 0;
  auto& taken = state.last.pose;
  Unit omega[3];
  for (int i = 0; i < 3; ++i) {
    taken[i] = clamp(x[i], kMaxStep);
    omega[i] = Unit::from_wide(taken[i]);
    const std::int64_t lever = taken[3 + i] = clamp(x[3 + i], kMaxStep);
    const int lever_log2 = lever_log2_of(state.input.target);
    state.pose.translation_mm[i] += Mm::from_wide(shift_round(lever, 12 - lever_log2));
  }
  rotate(state.pose, omega);
  for (int k = 0; k < 3; ++k) {
    Q<16>& term = state.edge_offset.terms[k];
    const Q<16> before = term;
    const std::int64_t change = clamp(x[6 + k], kMaxOffsetStep) * kOffsetScale;
    term = Q<16>::from_wide(clamp(term.raw() + shift_round(change, 14), kMaxEdgeOffset));
    taken[6 + k] = (std::int64_t{term.raw()} - before.raw()) * (1 << 14) / kOffsetScale;
  }
  return state.pose.translation_mm[2].raw() > 0;
}

// White or black beyond the scale's end, by `part` of the contrast, in more than half of the
// sectors: the outlines are where the end of the scale puts them.
bool is_clipped(const State& state, int part) {
  constexpr std::int32_t kEnd = kScaleEnd >> (8 - kLevelFraction);
  int clipped = 0;
  for (int k = 0; k < sectors_of(state); ++k) {
    const SectorLevel& level = state.workspace.levels.sectors[k];
    const std::int32_t beyond = level.contrast / part;
    const bool is_beyond = level.black < -beyond || level.black + level.contrast > kEnd + beyond;
    clipped += is_beyond ? 1 : 0;
  }
  return 2 * clipped > sectors_of(state);
}

// Mean squared residual after the step, with the unknowns' share given back, DN^2 Q<8>. Where white
// is clipped, what is left to be explained is taken for noise: level, blur and edge offset are
// nearly the same there, and what they share is not in the equations.
std::int64_t residual_variance(const State& state) {
  const OutlineNormal& n = state.workspace.normal;
  const std::int64_t unknowns = (2 * n.sectors + kOutlineUnknowns + 3) * 16;  // Q<4>
  if (n.pixels <= 2 * unknowns) return 0;
  // A model that explains all would leave no noise: an eighth is kept whatever happens.
  const std::int64_t most = n.square - n.square / 8;
  const std::int64_t explained = n.explained < most ? n.explained : most;
  return (n.square - (is_clipped(state, 64) ? 0 : explained)) / (n.pixels - unknowns);
}

void fill_covariance(State& state, std::int64_t sigma_q8, PoseCovariance& covariance) {
  const int lever_log2 = lever_log2_of(state.input.target);
  state.system.invert();
  int next = 0;
  for (int i = 0; i < 6; ++i) {
    // Per DN of noise, 36 bits: at most 2^-3 for a pose at all, so that the product fits.
    const std::int64_t unit = state.system.sigma(i, 14, 36);
    const std::int64_t sigma = unit > (std::int64_t{1} << 40) ? INT64_MAX >> 2 : unit * sigma_q8;
    if (i < 3) {
      covariance.sigma_rotation[i] = Angle::saturated(shift_round(sigma, 44 - 28));
    } else {
      covariance.sigma_translation_mm[i - 3] =
          Mm::saturated(shift_round(sigma, 44 - 18 - lever_log2));
    }
    for (int j = i + 1; j < 6; ++j) covariance.correlation[next++] = state.system.correlation(i, j);
  }
}

// Seen, but most of it rejected.
bool is_refused(const OutlineWorkspace& ws, int marker) {
  const int stations = ws.marker_stations[marker];
  return stations > 0 && 2 * ws.marker_rejected[marker] >= stations;
}

void fill_result(State& state, OutlineResult& result) {
  const OutlineWorkspace& ws = state.workspace;
  const OutlineNormal& n = ws.normal;
  result.pose = state.pose;
  result.blur = state.blur;
  result.edge_offset = state.edge_offset;
  const std::int64_t variance = residual_variance(state);
  result.noise_q8 = static_cast<std::int32_t>(isqrt(static_cast<std::uint64_t>(variance) << 8));
  fill_covariance(state, result.noise_q8, result.covariance);
  if (state.input.noise_q8 > 0) {
    result.residual_sigmas =
        Q<16>::saturated((std::int64_t{result.noise_q8} << 16) / state.input.noise_q8);
  }
  // Q<28> over Q<4>: mean square in Q<24>, to Q<32> before the root.
  if (n.information > 0) {
    const std::int64_t mean = (n.displacement / n.information) * (1 << 8);
    result.residual_px = Px::saturated(isqrt(static_cast<std::uint64_t>(mean)));
  }
  for (int k = 0; k < state.input.target.dot_count + 2; ++k) {
    if (ws.marker_stations[k] == 0) continue;
    result.stations += ws.marker_stations[k];
    result.rejected += ws.marker_rejected[k];
    auto& mask = is_refused(ws, k) ? result.markers_refused : result.markers_used;
    mask = static_cast<std::uint16_t>(mask | (1u << k));
  }
}

// Sizes that are not known yet, from the normal equations as they stand.
void estimate_sizes(const State& state, OutlineResult& result) {
  const OutlineNormal& n = state.workspace.normal;
  SizeTest test{state.system,
                {},
                n.pixels > 0 ? n.square / n.pixels + 1 : 1,
                lever_log2_of(state.input.target)};
  if (!state.system.solve(n.vector, test.solution, 27)) return;
  for (int k = 0; k < kMeasuredSizes; ++k) {
    if (!result.sizes[k].is_known) result.sizes[k] = estimate_size(test, n.sizes[k]);
  }
  const SizeRow& a = n.sizes[static_cast<int>(OutlineSize::kFirstWidth)];
  const SizeRow& b = n.sizes[static_cast<int>(OutlineSize::kSecondWidth)];
  SizeEstimate& both = result.sizes[static_cast<int>(OutlineSize::kBothWidths)];
  if (!both.is_known && a.self > 0 && b.self > 0) both = estimate_size(test, sum_of(a, b));
}

// Sigma of the blur, the mean of both axes.
Mm blur_on_plate(const State& state) {
  const std::int64_t variance = (std::int64_t{state.blur.xx.raw()} + state.blur.yy.raw()) / 2;
  const std::int64_t sigma_px = isqrt(static_cast<std::uint64_t>(variance) << 16);
  return Mm::from_wide(sigma_px * state.pose.translation_mm[2].raw() / state.input.camera.fx.raw());
}

bool is_kind_missing(const OutlineResult& result) {
  const auto is_known = [&](OutlineSize size) {
    return result.sizes[static_cast<int>(size)].is_known;
  };
  return !is_known(OutlineSize::kDotRadius) || !is_known(OutlineSize::kRingOuter) ||
         !is_known(OutlineSize::kRingInner) ||
         (!is_known(OutlineSize::kFirstWidth) && !is_known(OutlineSize::kSecondWidth));
}

// Of all outlines, were they square to the camera.
std::int64_t outline_px(const State& state) {
  return std::int64_t{outline_length(state.input.target).raw()} * state.input.camera.fx.raw() /
             state.pose.translation_mm[2].raw() >>
         16;
}

// Of a round, more than it takes: windows are as wide as blur makes them, a sixth wider where the
// outline is oblique to the scan lines, and near parts of the target are longer than on the mean.
std::uint32_t most_steps_of(const State& state, const Round& round) {
  const TargetModel& target = state.input.target;
  const auto segments = static_cast<std::uint32_t>(outline_segments(target, round.is_coarse));
  constexpr std::int64_t kMostPx = 1 << 13;
  const std::int64_t px = outline_px(state);
  const auto stations =
      static_cast<std::uint32_t>(clamp(px + px / 8, kMostPx) / round.stride) + segments;
  const Px window = reach_of(state.blur) * q<16>(7.0 / 3);
  const auto pixels = static_cast<std::uint32_t>(window.raw() >> 16) + 2;
  return kStepsPerRound + segments * kStepsPerSegment +
         stations *
             (kStepsPerStation + (pixels < kMaxWindow ? pixels : kMaxWindow) * kStepsPerPixel);
}

bool affords(const State& state, const Round& round) {
  const std::uint32_t steps = most_steps_of(state, round), most = state.input.most_steps;
  return steps <= most && state.steps <= most - steps;
}

// Outlines that were refused altogether may be of the wrong size: once more, displaced stations and
// all. Shadows that refuse a line move its two edges alike. False where there is no time for it.
bool judge_sizes(State& state, OutlineResult& result) {
  if (is_clipped(state, 16)) return true;
  state.steps += kStepsForSizes;
  estimate_sizes(state, result);
  if (is_kind_missing(result)) {
    if (!affords(state, kSizesRound)) return false;
    state.ordinary_q8 = 0;  // all weigh the same
    measure_all(state, kSizesRound);
    sum_sectors(state);
    if (factor(state)) estimate_sizes(state, result);
  }
  result.has_wrong_size = has_wrong_size(result.sizes, state.input.target, blur_on_plate(state));
  return true;
}

// What ordinary pixels are off by: the median of the sectors, their levels eliminated, less what
// the step takes off. Half of it at least: where the step belongs to few of them, it is not theirs.
std::int32_t ordinary_square(const State& state) {
  const OutlineWorkspace& ws = state.workspace;
  std::int64_t sorted[kMaxSectors];
  for (int count = 0; count < ws.used_count; ++count) {
    const SectorEquations& sector = ws.used[count];
    const std::int64_t mean = (sector.square - sector.explained) / sector.pixels;  // Q<8>
    int at = count;
    for (; at > 0 && sorted[at - 1] > mean; --at) sorted[at] = sorted[at - 1];
    sorted[at] = mean;
  }
  const std::int64_t median = sorted[ws.used_count / 2];
  const std::int64_t rest = median - state.explained_q8;
  return saturate32(rest > median / 2 ? rest : median / 2);
}

// False where the round does not fit in time or leaves too little outline for a pose.
bool run(State& state, const Round& round) {
  OutlineWorkspace& ws = state.workspace;
  state.is_late = !affords(state, round);
  if (state.is_late) return false;
  measure_all(state, round);
  if (ws.used_count < kFewestSectors || !step(state, round)) return false;
  const ImageBlur before = state.blur;
  if (round.is_coarse || !state.is_blur_settled) {
    state.is_blur_settled = update_blur(ws.blur, state.blur_growth, state.blur);
  }
  state.last.blur[0] = (state.blur.xx - before.xx).raw();
  state.last.blur[1] = (state.blur.xy - before.xy).raw();
  state.last.blur[2] = (state.blur.yy - before.yy).raw();
  const bool follows = !is_clipped(state, 64);
  for (int k = 0; k < sectors_of(state) && follows; ++k) {
    SectorLevel& level = ws.levels.sectors[k];
    if (!is_censored(state, level)) follow_step(ws.shares[k], state.last, level);
  }
  fit_light(sectors_of(state), ws.levels);
  state.ordinary_q8 = ordinary_square(state);
  return true;
}

// A step of d leaves d^3 / (2 s^2) to the next: whether that is less than a twentieth of what noise
// leaves, sigma^2 for each unknown over the information.
bool is_there(const State& state) {
  const OutlineNormal& n = state.workspace.normal;
  if (n.information <= 0 || state.shift_square >= 1 << 20) return false;
  const std::int64_t sum = kOutlineUnknowns * std::int64_t{state.ordinary_q8};
  const std::int64_t noise =  // px^2 Q<32>; (1/4 px)^2 is as good as more
      clamp(clamp(sum, kMostVariance) * (1 << 28) / n.information, 1 << 28);
  const std::int64_t variance = (std::int64_t{state.blur.xx.raw()} + state.blur.yy.raw()) >> 5;
  const std::int64_t cube = state.shift_square * state.shift_square * state.shift_square;  // Q<60>
  return (cube >> 4) * 100 < noise * (variance * variance);                                // Q<56>
}

// Whether nothing but the sensor's noise is seen beside what the step explains: by a quarter, and
// in all sectors.
bool is_plain(const State& state) {
  const std::int64_t noise = scale_noise(state.input.noise_q8);  // DN Q<8>
  return 4 * 256 * std::int64_t{state.ordinary_q8} < 5 * noise * noise;
}

// Pose, blur and light near enough for outliers to show; and what they are, where they have kept
// it from coming near soon.
bool come_near(State& state) {
  int rounds = 0;
  bool is_near = false;
  for (; rounds < kMostCoarseRounds && !is_near; ++rounds) {
    const bool is_first_near = rounds == 0 && outline_px(state) > kNearOutline;
    if (!run(state, is_first_near ? kFirstNear : kCoarseRound)) return false;
    const bool is_small =
        is_plain(state) ? is_there(state) : rounds > 0 && state.shift_square < kNearSquare;
    is_near = is_small && state.is_blur_settled;
  }
  return rounds <= kSoon || run(state, kJudgedRound);
}

// Bit per marker.
unsigned refused_of(const State& state) {
  unsigned mask = 0;
  for (int k = 0; k < state.input.target.dot_count + 2; ++k) {
    if (is_refused(state.workspace, k)) mask |= 1u << k;
  }
  return mask;
}

// All of the outlines, without outliers: again where there are others than before.
bool fit_outlines(State& state) {
  unsigned refused = refused_of(state);
  for (int i = 0; i < kMostFineRounds; ++i) {
    if (!run(state, kFineRound)) return false;
    const unsigned before = refused;
    refused = refused_of(state);
    if (refused == before && state.is_blur_settled && is_there(state)) break;
  }
  return true;
}

}  // namespace

void refine_outlines(const OutlineInput& input, OutlineWorkspace& workspace,
                     OutlineResult& result) {
  result = OutlineResult{};
  result.pose = input.start;
  if (input.start.translation_mm[2].raw() <= 0) return;
  new (&workspace) OutlineWorkspace;
  State state{input, workspace, input.start, start_blur(input), {}, 0, {}};
  start_levels(input.black, input.white, sectors_of(state), workspace.levels);
  const bool is_solved = come_near(state) && fit_outlines(state);
  if (is_solved) {
    fill_result(state, result);
    state.is_late = !judge_sizes(state, result);
  }
  result.steps = state.steps;
  if (state.is_late) {
    result.reason = Reason::kDeadline;
  } else if (is_solved) {
    result.reason = Reason::kNone;
  }
}

}  // namespace berth
