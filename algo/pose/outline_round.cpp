#include "pose/outline_round.hpp"

#include <new>

#include "fixed/roots.hpp"

namespace berth {
namespace {

constexpr std::int64_t kKeptSquare = q<20>(0.01).raw();  // px^2 Q<20>: 0.1 px, vertices are shifted
constexpr Px kReachPad = q<16>(0.5);
// Work of a round, a segment, a station, a pixel, in instructions of the Cortex-M7.
constexpr std::uint32_t kStepsPerRound = 310000, kStepsPerSegment = 3600;
constexpr std::uint32_t kStepsPerStation = 130, kStepsPerPixel = 59;

// 3 sigma of the widest blur, for margins at occlusions.
Px reach_of(const ImageBlur& blur) {
  const std::int64_t floor = blur_floor(blur).raw();
  const std::int64_t largest = std::int64_t{blur.xx.raw()} + blur.yy.raw() - floor;
  const std::int64_t sigma = isqrt(static_cast<std::uint64_t>(largest) << 16);
  return Px::from_wide(3 * sigma) + kReachPad;
}

LayoutScale layout_scale(const OutlineState& state, Px reach, bool is_coarse) {
  const Mm z = state.pose.translation_mm[2];
  const Q<16> px_per_mm =
      Q<16>::saturated((std::int64_t{state.input.camera.fx.raw()} << 18) / z.raw());
  const std::int32_t least = px_per_mm.raw() < 64 ? 64 : px_per_mm.raw();
  return {Mm::saturated((std::int64_t{reach.raw()} << 18) / least), is_coarse};
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
void place_sector(OutlineState& state, const OutlineView& view, const OutlineSector& sector,
                  int k) {
  const std::int8_t raised = sector.pieces[0].raised;
  const Mm z = raised >= 0 ? state.input.target.dots[raised].center_mm[2] : Mm(0);
  auto& place_by_px = state.workspace.place_by_px[k];
  if (!place_by_pixel(view, Vec3Mm(sector.center_x, sector.center_y, z), place_by_px)) {
    for (auto& row : place_by_px) row[0] = row[1] = Q<16>(0);
  }
}

SectorLight light_sector(const OutlineState& state, const OutlineView& view,
                         const OutlineSector& sector, int k, SegmentModel& model) {
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
  Tracer(OutlineState& state, const OutlineView& view, const OutlineRound& round)
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
  OutlineState& state_;
  OutlineWalk walk_;
  int next_ = 0;
  bool keeps_, shifts_;
};

void measure_piece(OutlineState& state, Tracer& tracer, const OutlinePiece& piece,
                   const SectorLight& light, SegmentModel& model) {
  OutlineWorkspace& ws = state.workspace;
  const int lever_log2 = lever_log2_of(state.input.target);
  OutlineVertex last = tracer.next();
  for (int i = 1; i <= piece.segments; ++i) {  // at most kDotSegments
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
                     static_cast<std::uint32_t>(sums.pixel_work) * kStepsPerPixel;
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

}  // namespace

std::int32_t scale_noise(std::int32_t noise_q8) {
  constexpr std::int32_t kUnknown = 2 << 8, kRounding = (1 << 16) / 12, kMost = 1 << 12;
  if (noise_q8 <= 0 || noise_q8 > kMost) return kUnknown;
  return static_cast<std::int32_t>(isqrt(
      static_cast<std::uint64_t>(noise_q8) * static_cast<std::uint64_t>(noise_q8) + kRounding));
}

bool is_censored(const OutlineState& state, const SectorLevel& level) {
  constexpr std::int32_t kEnd = kScaleEnd >> (8 - kLevelFraction);
  const std::int32_t near = (5 * scale_noise(state.input.noise_q8) / 2) >> (8 - kLevelFraction);
  return level.black < near || level.black + level.contrast > kEnd - near;
}

bool is_clipped(const OutlineState& state, int part, SectorRange sectors) {
  constexpr std::int32_t kEnd = kScaleEnd >> (8 - kLevelFraction);
  int clipped = 0;
  for (int k = sectors.first; k < sectors.end; ++k) {
    const SectorLevel& level = state.workspace.levels.sectors[k];
    const std::int32_t beyond = level.contrast / part;
    const bool is_beyond = level.black < -beyond || level.black + level.contrast > kEnd + beyond;
    clipped += is_beyond ? 1 : 0;
  }
  return 2 * clipped > sectors.end - sectors.first;
}

bool is_clipped(const OutlineState& state, int part) {
  return is_clipped(state, part, {0, sectors_of(state)});
}

namespace {

// The levels go where the last step puts them, and light with them.
void follow(OutlineState& state) {
  OutlineWorkspace& ws = state.workspace;
  const bool follows = !is_clipped(state, 64);
  for (int k = 0; k < sectors_of(state) && follows; ++k) {
    SectorLevel& level = ws.levels.sectors[k];
    if (!is_censored(state, level)) follow_step(ws.shares[k], state.last, level);
  }
  fit_light(sectors_of(state), ws.levels);
  state.is_followed = true;
}

// False where the sector does not show its marker in even light.
bool take_sector(const OutlineState& state, const OutlineRound& round, bool with_blur, int k) {
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

// Fills the workspace's sector and what is kept of it.
void measure_sector(OutlineState& state, const OutlineView& view, const OutlineSector& sector,
                    Tracer& tracer, int k, SegmentModel& model) {
  OutlineWorkspace& ws = state.workspace;
  SectorLevel& level = ws.levels.sectors[k];
  level.x = sector.center_x;
  level.y = sector.center_y;
  new (&ws.sector) SectorSums();
  ws.sector.size = sector.pieces[0].size;
  ws.sector_blur = SectorBlur{};
  const SectorLight light = light_sector(state, view, sector, k, model);
  for (int i = 0; i < sector.count; ++i) {
    tracer.begin(sector.pieces[i], k, i);
    measure_piece(state, tracer, sector.pieces[i], light, model);
  }
  update_sector_level(ws.sector, level);
  keep_share(ws.sector, ws.sector_blur, ws.shares[k]);
}

// Where the pose is near, and outliers are judged.
bool finds_levels(const OutlineRound& round) { return !round.is_coarse && round.judge_shift; }

// A sector that was refused may lie in a light of its own: all stations alike say which.
void find_levels(OutlineState& state, const OutlineView& view, const OutlineSector& sector,
                 Tracer& tracer, int k, SegmentModel model) {
  SectorLevel& level = state.workspace.levels.sectors[k];
  const SectorLevel before = level;
  model.ordinary_q8 = 0;
  model.judge_shift = model.with_blur = false;
  measure_sector(state, view, sector, tracer, k, model);
  if (!level.trusted || !shows_marker(state.workspace.levels, k)) level = before;
}

}  // namespace

void measure_outlines(OutlineState& state, const OutlineRound& round) {
  OutlineWorkspace& ws = state.workspace;
  state.steps += kStepsPerRound;
  if (!state.is_followed) follow(state);
  ws.blur = BlurNormal{};
  ws.used_count = 0;
  for (int k = 0; k < kMaxMarkers; ++k) ws.marker_stations[k] = ws.marker_rejected[k] = 0;
  SegmentModel model;
  model.blur = state.blur;
  model.blur_floor = blur_floor(state.blur);
  model.ordinary_q8 = state.ordinary_q8;
  model.judge_shift = round.judge_shift;
  model.with_blur = measures_blur(state, round);
  model.edge_offset = state.edge_offset;
  model.noise_q8 = scale_noise(state.input.noise_q8);
  model.stride = round.stride;
  const Px reach = reach_of(state.blur);
  const OutlineView view =
      make_outline_view(state.input.camera, state.input.target, state.pose, reach);
  const LayoutScale scale = layout_scale(state, reach, round.is_coarse);
  Tracer tracer(state, view, round);
  for (int k = 0; k < sectors_of(state); ++k) {
    const OutlineSector sector = make_outline_sector(state.input.target, k, scale);
    SectorLevel& level = ws.levels.sectors[k];
    const SectorLevel before = level;
    const bool is_tried_again = !level.trusted && finds_levels(round);
    if (is_tried_again) find_levels(state, view, sector, tracer, k, model);
    if (round.is_coarse && !tracer.shifts()) place_sector(state, view, sector, k);
    measure_sector(state, view, sector, tracer, k, model);
    const bool usable = take_sector(state, round, model.with_blur, k);
    if (is_tried_again && !usable) level = before;
    ws.marker_stations[sector.marker] =
        static_cast<std::uint16_t>(ws.marker_stations[sector.marker] + ws.sector.stations);
    ws.marker_rejected[sector.marker] = static_cast<std::uint16_t>(
        ws.marker_rejected[sector.marker] + (usable ? ws.sector.rejected : ws.sector.stations));
  }
}

std::int64_t outline_px(const OutlineState& state) {
  return std::int64_t{outline_length(state.input.target).raw()} * state.input.camera.fx.raw() /
             state.pose.translation_mm[2].raw() >>
         16;
}

namespace {

bool has_censored(const OutlineState& state) {
  for (int k = 0; k < sectors_of(state); ++k) {
    if (is_censored(state, state.workspace.levels.sectors[k])) return true;
  }
  return false;
}

std::uint32_t refused_of(const OutlineState& state) {
  std::uint32_t refused = 0;
  for (int k = 0; k < sectors_of(state); ++k) {
    refused += state.workspace.levels.sectors[k].trusted ? 0 : 1;
  }
  return refused;
}

}  // namespace

// Of a round, more than it takes: windows are as wide as blur makes them, a sixth wider where the
// outline is oblique to the scan lines, and near parts of the target are longer than on the mean.
// Sectors that were refused are measured twice.
std::uint32_t most_steps_of(const OutlineState& state, const OutlineRound& round) {
  const TargetModel& target = state.input.target;
  const auto segments = static_cast<std::uint32_t>(outline_segments(target, round.is_coarse));
  constexpr std::int64_t kMostPx = 1 << 13;
  const std::int64_t px = outline_px(state);
  const auto stations =
      static_cast<std::uint32_t>(clamp_to(px + px / 8, kMostPx) / round.stride) + segments;
  const Px window = reach_of(state.blur) * q<16>(7.0 / 3);
  const auto seen = static_cast<std::uint32_t>(window.raw() >> 16) + 2;
  std::uint32_t pixels = seen < kMaxWindow ? seen : kMaxWindow;
  if (has_censored(state)) pixels *= 2;
  const std::uint32_t once =
      segments * kStepsPerSegment + stations * (kStepsPerStation + pixels * kStepsPerPixel);
  const auto sectors = static_cast<std::uint32_t>(sectors_of(state));
  return kStepsPerRound +
         once / sectors * (sectors + (finds_levels(round) ? refused_of(state) : 0));
}

}  // namespace berth
