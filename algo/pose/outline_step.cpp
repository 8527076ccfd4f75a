#include "pose/outline_step.hpp"

#include <new>

namespace berth {
namespace {

constexpr std::int64_t kMaxStep = q<30>(0.1).raw();  // rad, lever
constexpr std::int64_t kMaxOffsetStep = q<30>(0.02).raw();
constexpr std::int32_t kMaxEdgeOffset = q<16>(0.8).raw();
constexpr std::int64_t kMostGain = std::int64_t{1} << 50;

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

// Edge offset: o within 0.3, as a prior in units of the noise; o / 16 is the unknown.
void add_offset_prior(const OutlineState& state, OutlineNormal& n) {
  const std::int64_t variance = n.pixels > 0 ? (n.square / n.pixels) + 1 : 1;  // Q<8>
  for (int k = 0; k < 3; ++k) {
    n.matrix[diagonal_term(6 + k)] += (variance * 2844) << 6;
    n.vector[6 + k] -=
        shift_round(((variance * 2844) * state.edge_offset.terms[k].raw()) / kOffsetScale, 7);
  }
}

// What of them is too much: a sector of excess F weighs 1 / F.
void weigh_sectors(OutlineState& state, const std::int64_t (&step)[kOutlineUnknowns]) {
  OutlineWorkspace& ws = state.workspace;
  for (int k = 0; k < ws.used_count; ++k) {
    const SectorEquations& sector = ws.used[k];
    const std::int64_t excess = excess_q8(sector, gain_of_step(sector, step), state.ordinary_q8);
    const auto weight = static_cast<std::int32_t>((1 << 16) / excess);
    if (weight < kWholeSector) add_sector(sector, weight - kWholeSector, ws.normal);
  }
}

bool solve(OutlineState& state, std::int64_t (&x)[kOutlineUnknowns]) {
  return factor_equations(state) && state.system.solve(state.workspace.normal.vector, x, 27);
}

}  // namespace

bool factor_equations(OutlineState& state) {
  std::int64_t square[kOutlineUnknowns][kOutlineUnknowns];
  const std::int64_t* term = state.workspace.normal.matrix;
  for (int i = 0; i < kOutlineUnknowns; ++i) {
    for (int k = 0; k <= i; ++k) square[i][k] = *term++;
  }
  return state.system.factor(square);
}

void sum_sectors(OutlineState& state) {
  OutlineWorkspace& ws = state.workspace;
  new (&ws.normal) OutlineNormal();
  for (int k = 0; k < ws.used_count; ++k) {
    add_sector(ws.used[k], kWholeSector, ws.normal);
    ws.normal.segments += ws.used[k].segments;
  }
  ws.normal.sectors = ws.used_count;
  add_offset_prior(state, ws.normal);
}

bool take_step(OutlineState& state, const OutlineRound& round) {
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
  state.shift_square =
      n.information > 0 ? (clamp_to(gain, kMostGain) * (1 << 12)) / n.information : 0;
  auto& taken = state.last.pose;
  Unit omega[3];
  for (int i = 0; i < 3; ++i) {
    taken[i] = clamp_to(x[i], kMaxStep);
    omega[i] = Unit::from_wide(taken[i]);
    const std::int64_t lever = taken[3 + i] = clamp_to(x[3 + i], kMaxStep);
    const int lever_log2 = lever_log2_of(state.input.target);
    state.pose.translation_mm[i] += Mm::from_wide(shift_round(lever, 12 - lever_log2));
  }
  rotate(state.pose, omega);
  for (int k = 0; k < 3; ++k) {
    Q<16>& term = state.edge_offset.terms[k];
    const Q<16> before = term;
    const std::int64_t change = clamp_to(x[6 + k], kMaxOffsetStep) * kOffsetScale;
    term = Q<16>::from_wide(clamp_to(term.raw() + shift_round(change, 14), kMaxEdgeOffset));
    taken[6 + k] = (std::int64_t{term.raw()} - before.raw()) * (1 << 14) / kOffsetScale;
  }
  return state.pose.translation_mm[2].raw() > 0;
}

}  // namespace berth
