#include "app/parameter_block.hpp"
#include "camera/validate_camera.hpp"
#include "core/work.hpp"
#include "fixed/roots.hpp"
#include "target/validate_target.hpp"

namespace berth {
namespace {

// Rows rounded to 2^-30 are orthonormal to about 3 x 2^-31 x sqrt(3); host files carry a little
// more through the nearest rotation. Products of two Q30 are summed in 64 bits at 2^-60.
constexpr std::int64_t kOrthonormalTolerance = std::int64_t{1} << (60 - 26);

// T_EL must fit Q18 (8192 mm) with the target as far away as its size allows: 1500 mm for a plate
// of 120 mm, 12.5 plates, and a little more.
constexpr Mm kMaxMount = q<18>(4000.0);
constexpr Mm kMaxReach = q<18>(8100.0);
constexpr std::int32_t kFarthestPlates = 13;

template <int F>
bool is_within(Q<F> value, Q<F> low, Q<F> high) {
  return value >= low && value <= high;
}

std::int64_t magnitude(std::int64_t value) { return value < 0 ? -value : value; }

std::int64_t product(Unit a, Unit b) { return std::int64_t{a.raw()} * b.raw(); }

bool has_unit_range(const Mat3Unit& r) {
  constexpr Unit kAboveOne = q<30>(1.0001);
  for (int i = 0; i < 9; ++i) {
    if (!is_within(r(i / 3, i % 3), -kAboveOne, kAboveOne)) return false;
  }
  return true;
}

bool is_orthonormal(const Mat3Unit& r) {
  constexpr std::int64_t kOne = std::int64_t{1} << 60;
  for (int a = 0; a < 3; ++a) {
    for (int b = a; b < 3; ++b) {
      // Three products of at most 2^60 (1.0002) stay below 2^62.
      const std::int64_t dot =
          product(r(a, 0), r(b, 0)) + product(r(a, 1), r(b, 1)) + product(r(a, 2), r(b, 2));
      if (magnitude(dot - (a == b ? kOne : 0)) > kOrthonormalTolerance) return false;
    }
  }
  return true;
}

/// Of orthonormal rows: the third is the cross product of the first two, not its opposite.
bool is_right_handed(const Mat3Unit& r) {
  std::int64_t agreement = 0;  // products of two Q30, halved to 2^-59: below 2^61
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    const std::int64_t cross = product(r(0, j), r(1, k)) - product(r(0, k), r(1, j));
    agreement += product(Unit::from_wide(shift_round(cross, 30)), r(2, i)) / 2;
  }
  return agreement > 0;
}

bool is_rotation(const Mat3Unit& r) {
  return has_unit_range(r) && is_orthonormal(r) && is_right_handed(r);
}

Mm max_of(Mm a, Mm b) { return a > b ? a : b; }

/// Length of a vector of components of at most kMaxMount, as a raw Mm. Squares at 2^-24 mm^2 stay
/// below 2^48.
std::int64_t length(const Vec3Mm& v) {
  std::uint64_t sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t coarse = v[axis].to<12>().raw();
    sum += static_cast<std::uint64_t>(coarse * coarse);
  }
  return std::int64_t{Q<12>::from_wide(isqrt(sum)).to<18>().raw()};
}

FieldFault check_mounts(const Parameters& p) {
  if (!is_rotation(p.effector_from_camera.rotation)) return {"mount.T_EC.rotation"};
  if (!is_rotation(p.target_from_latch.rotation)) return {"mount.T_TL.rotation"};
  for (int axis = 0; axis < 3; ++axis) {
    if (!is_within(p.effector_from_camera.translation_mm[axis], -kMaxMount, kMaxMount)) {
      return {"mount.T_EC.translation_mm[]", axis};
    }
    if (!is_within(p.target_from_latch.translation_mm[axis], -kMaxMount, kMaxMount)) {
      return {"mount.T_TL.translation_mm[]", axis};
    }
  }
  const Mm side = max_of(p.target.plate_width_mm, p.target.plate_height_mm);
  const std::int64_t reach = length(p.effector_from_camera.translation_mm) +
                             length(p.target_from_latch.translation_mm) +
                             std::int64_t{side.raw()} * kFarthestPlates;
  return reach > kMaxReach.raw() ? FieldFault{"mount.T_EC.translation_mm"} : FieldFault{};
}

FieldFault check_thresholds(const Thresholds& t) {
  if (!is_within(t.false_rotation, q<28>(0.0001), q<28>(0.8))) {
    return {"thresholds.false_rotation"};
  }
  if (!is_within(t.false_translation, q<24>(0.0001), q<24>(0.5))) {
    return {"thresholds.false_translation"};
  }
  if (!is_within(t.ambiguity_ratio, Unit(0), Unit(1))) return {"thresholds.ambiguity_ratio"};
  if (!is_within(t.residual_sigmas, q<16>(1.0), q<16>(100.0))) {
    return {"thresholds.residual_sigmas"};
  }
  if (!is_within(t.edge_sigmas, q<16>(1.0), q<16>(100.0))) return {"thresholds.edge_sigmas"};
  const auto is_budget = [](std::int32_t units) { return units >= 0 && units <= kMaxBudget_units; };
  if (!is_budget(t.search_budget_units)) return {"thresholds.search_budget_units"};
  if (!is_budget(t.frame_budget_units)) return {"thresholds.frame_budget_units"};
  return {};
}

BlockStatus out_of_range(FieldFault fault) {
  BlockStatus status;
  status.code = BlockCode::kOutOfRange;
  status.fault = fault;
  return status;
}

}  // namespace

BlockStatus validate_parameters(const Parameters& parameters) {
  FieldFault fault = validate_camera(parameters.camera);
  if (!fault.is_fault()) fault = validate_target(parameters.target);
  if (!fault.is_fault()) fault = check_mounts(parameters);
  if (!fault.is_fault()) fault = check_thresholds(parameters.thresholds);
  return fault.is_fault() ? out_of_range(fault) : BlockStatus{};
}

}  // namespace berth
