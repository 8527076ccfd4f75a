#include <new>

#include "fixed/roots.hpp"
#include "pose/outline_step.hpp"

namespace berth {
namespace {

constexpr std::int64_t kNearSquare = q<20>(0.0025).raw();  // px^2 Q<20>: 0.05 px, outliers show
constexpr int kMostCoarseRounds = 6, kMostFineRounds = 3, kSoon = 2;
// From afar every eighth line would leave a dot's segments without any.
constexpr OutlineRound kFirstNear = {8, true, false};
constexpr std::int64_t kNearOutline = 1200;  // px of all outlines
constexpr OutlineRound kCoarseRound = {4, true, false}, kJudgedRound = {2, true, true};
constexpr OutlineRound kFineRound = {1, false, true};
constexpr OutlineRound kSizesRound = {2, false, false};
constexpr std::uint32_t kStepsForSizes = 100000;  // instructions of the Cortex-M7
constexpr std::int64_t kMostVariance = std::int64_t{1} << 32;
constexpr int kFewestSectors = 6;
// px^2 Q<20>: a step of more is towards a wrong edge.
constexpr std::int64_t kLostSquare = q<20>(1.0).raw();
constexpr std::int64_t kLeastStart = q<16>(0.4).raw();  // px^2: sharper blur reaches too few pixels

// From sigma on the plate, where tilt foreshortens one direction. The profiles that saw it
// interpolate between pixels, which adds a sixth of a pixel squared.
ImageBlur round_start(const OutlineInput& input) {
  constexpr std::int64_t kMost = 16 << 16;  // px Q<16>
  const std::int64_t front = clamp_to(std::int64_t{input.blur_mm.raw()} * input.camera.fx.raw() /
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

// Mean squared residual after the step, with the unknowns' share given back, DN^2 Q<8>. Where white
// is clipped, what is left to be explained is taken for noise: level, blur and edge offset are
// nearly the same there, and what they share is not in the equations.
std::int64_t residual_variance(const OutlineState& state) {
  const OutlineNormal& n = state.workspace.normal;
  const std::int64_t unknowns = (2 * n.sectors + kOutlineUnknowns + 3) * 16;  // Q<4>
  if (n.pixels <= 2 * unknowns) return 0;
  // A model that explains all would leave no noise: an eighth is kept whatever happens.
  const std::int64_t most = n.square - n.square / 8;
  const std::int64_t explained = n.explained < most ? n.explained : most;
  return (n.square - (is_clipped(state, 64) ? 0 : explained)) / (n.pixels - unknowns);
}

void fill_covariance(OutlineState& state, std::int64_t sigma_q8, PoseCovariance& covariance) {
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

void fill_result(OutlineState& state, OutlineResult& result) {
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
void estimate_sizes(const OutlineState& state, OutlineResult& result) {
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
Mm blur_on_plate(const OutlineState& state) {
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

bool affords(const OutlineState& state, const OutlineRound& round) {
  const std::uint32_t steps = most_steps_of(state, round), most = state.input.most_steps;
  return steps <= most && state.steps <= most - steps;
}

// Sizes of what lies beyond the scale; and of the dots where the first fit refused nearly all: what
// gamma makes of small ones in strong blur may be why.
void forget_doubtful(const OutlineState& state, OutlineResult& result) {
  const TargetModel& target = state.input.target;
  const SectorRange kinds[] = {dot_sectors(target), ring_sectors(target), line_sectors(target)};
  for (int kind = 0; kind < 3; ++kind) {  // of two sizes each
    if (!is_clipped(state, 16, kinds[kind])) continue;
    result.sizes[2 * kind].is_known = result.sizes[2 * kind + 1].is_known = false;
  }
  if (state.is_second_fit) result.sizes[static_cast<int>(OutlineSize::kDotRadius)].is_known = false;
}

// Outlines that were refused altogether may be of the wrong size: once more, displaced stations and
// all. Shadows that refuse a line move its two edges alike. False where there is no time for it.
bool judge_sizes(OutlineState& state, OutlineResult& result) {
  if (is_clipped(state, 16)) return true;
  state.steps += kStepsForSizes;
  estimate_sizes(state, result);
  if (is_kind_missing(result)) {
    if (!affords(state, kSizesRound)) return false;
    state.ordinary_q8 = 0;  // all weigh the same
    measure_outlines(state, kSizesRound);
    sum_sectors(state);
    if (factor_equations(state)) estimate_sizes(state, result);
  }
  forget_doubtful(state, result);
  const Mm blur = blur_on_plate(state);
  const std::int64_t facing = abs(state.pose.rotation(2, 2)).raw() + std::int64_t{1};  // no zero
  const Mm widest = Mm::saturated((std::int64_t{blur.raw()} << 30) / facing);
  result.has_wrong_size = has_wrong_size(result.sizes, state.input.target, blur, widest);
  return true;
}

// What ordinary pixels are off by: the median of the sectors, their levels eliminated, less what
// the step takes off. Half of it at least: where the step belongs to few of them, it is not theirs.
std::int32_t ordinary_square(const OutlineState& state) {
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
bool run(OutlineState& state, const OutlineRound& round) {
  OutlineWorkspace& ws = state.workspace;
  state.is_late = !affords(state, round);
  if (state.is_late) return false;
  measure_outlines(state, round);
  if (ws.used_count < kFewestSectors || !take_step(state, round)) return false;
  const ImageBlur before = state.blur;
  if (measures_blur(state, round)) {
    state.blur_change = update_blur(ws.blur, state.blur_growth, state.blur);
  }
  state.is_followed = false;
  state.last.blur[0] = (state.blur.xx - before.xx).raw();
  state.last.blur[1] = (state.blur.xy - before.xy).raw();
  state.last.blur[2] = (state.blur.yy - before.yy).raw();
  state.ordinary_q8 = ordinary_square(state);
  return true;
}

// A step of d leaves d^3 / (2 s^2) to the next: whether that is less than a twentieth of what noise
// leaves, sigma^2 for each unknown over the information.
bool is_there(const OutlineState& state) {
  const OutlineNormal& n = state.workspace.normal;
  if (n.information <= 0 || state.shift_square >= 1 << 20) return false;
  const std::int64_t sum = kOutlineUnknowns * std::int64_t{state.ordinary_q8};
  const std::int64_t noise =  // px^2 Q<32>; (1/4 px)^2 is as good as more
      clamp_to(clamp_to(sum, kMostVariance) * (1 << 28) / n.information, 1 << 28);
  const std::int64_t variance = (std::int64_t{state.blur.xx.raw()} + state.blur.yy.raw()) >> 5;
  const std::int64_t cube = state.shift_square * state.shift_square * state.shift_square;  // Q<60>
  return (cube >> 4) * 100 < noise * (variance * variance);                                // Q<56>
}

// Whether most sectors show nothing but the sensor's noise, by a quarter more at most, beside what
// the step explains.
bool is_plain(const OutlineState& state) {
  const std::int64_t noise = scale_noise(state.input.noise_q8);  // DN Q<8>
  return 4 * 256 * std::int64_t{state.ordinary_q8} < 5 * noise * noise;
}

// Pose, blur and light near enough for outliers to show; and what they are, where they have kept
// it from coming near soon.
bool come_near(OutlineState& state) {
  int rounds = 0;
  bool is_near = false;
  for (; rounds < kMostCoarseRounds && !is_near; ++rounds) {
    const bool is_first_near = rounds == 0 && outline_px(state) > kNearOutline;
    if (!run(state, is_first_near ? kFirstNear : kCoarseRound)) return false;
    const bool is_small =
        is_plain(state) ? is_there(state) : rounds > 0 && state.shift_square < kNearSquare;
    is_near = is_small && state.blur_change.is_small;
  }
  return rounds <= kSoon || run(state, kJudgedRound);
}

// Bit per marker.
unsigned refused_of(const OutlineState& state) {
  unsigned mask = 0;
  for (int k = 0; k < state.input.target.dot_count + 2; ++k) {
    if (is_refused(state.workspace, k)) mask |= 1u << k;
  }
  return mask;
}

// All of the outlines, without outliers: again where there are others than before.
bool fit_outlines(OutlineState& state) {
  unsigned refused = refused_of(state);
  for (int i = 0; i < kMostFineRounds; ++i) {
    if (!run(state, kFineRound)) return false;
    const unsigned before = refused;
    refused = refused_of(state);
    if (refused == before && state.blur_change.is_small && is_there(state)) break;
  }
  return true;
}

bool fit(OutlineState& state) { return come_near(state) && fit_outlines(state); }

// Where light or start were so far off that the first rounds' residuals do not tell what is
// ordinary, nearly all is refused: once more from here, with the levels known by now.
bool fit_once_more(OutlineState& state) {
  if (state.is_late || state.shift_square > kLostSquare) return false;
  state.ordinary_q8 = 0;
  state.is_second_fit = true;
  return fit(state);
}

}  // namespace

void refine_outlines(const OutlineInput& input, OutlineWorkspace& workspace,
                     OutlineResult& result) {
  result = OutlineResult{};
  result.pose = input.start;
  if (input.start.translation_mm[2].raw() <= 0) return;
  new (&workspace) OutlineWorkspace;
  OutlineState state{input, workspace, input.start, start_blur(input), {}, 0, {}};
  start_levels(input.black, input.white, sectors_of(state), workspace.levels);
  const bool is_solved = fit(state) || fit_once_more(state);
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
