#include "pose/outline_sizes.hpp"

#include "fixed/roots.hpp"
#include "fixed/wide.hpp"

namespace berth {
namespace {

constexpr std::int32_t kMostGain = 1 << 15;

Mm half(Mm a) { return Mm::from_raw(a.raw() / 2); }

Mm mean_radius(const TargetModel& target) {
  std::int64_t radii = 0;
  for (int d = 0; d < target.dot_count; ++d) radii += target.dots[d].radius_mm.raw();
  return Mm::from_wide(target.dot_count > 0 ? radii / target.dot_count : 0);
}

// Not measured, or off by more than a third of `dimension`: something is in its place.
bool is_hidden(const SizeEstimate& size, Mm dimension) {
  return !size.is_known || 3 * std::int64_t{abs(size.off_mm).raw()} > dimension.raw();
}

// By how many half sigmas a size is off, with its sign; 0 where it is off by less than `least_mm`.
std::int64_t half_sigmas_off(const SizeEstimate& size, Mm dimension, Mm least_mm) {
  constexpr std::int64_t kMost = 1000;
  const std::int64_t off = abs(size.off_mm).raw();
  if (is_hidden(size, dimension) || off < least_mm.raw()) return 0;
  const std::int64_t count = 2 * off / size.sigma_mm.raw();
  const std::int64_t most = count < kMost ? count : kMost;
  return size.off_mm.raw() > 0 ? most : -most;
}

Mm part_of(Mm dimension) { return Mm::from_raw(dimension.raw() / 25); }

// What gamma and point spreads make of a round edge, unlike of a straight one: half of s^2 / r.
Mm of_curvature(Mm radius, Mm sigma) {
  if (radius.raw() <= 0) return Mm(0);
  return Mm::from_wide(std::int64_t{sigma.raw()} * sigma.raw() / 2 / radius.raw());
}

// Lever Q<30> to mm.
Mm from_lever(std::int64_t value, int lever_log2) {
  return Mm::saturated(shift_round(value, 12 - lever_log2));
}

// What another shape of the blur makes of two edges 2 w apart: a sixteenth of s^2 / w.
Mm of_shape(Mm half_width, Mm sigma) {
  if (half_width.raw() <= 0) return Mm(0);
  return Mm::from_wide(std::int64_t{sigma.raw()} * sigma.raw() / 16 / half_width.raw());
}

}  // namespace

std::int32_t size_gain(const OutlinePiece& piece, const OutlineVertex& a, const OutlineVertex& b,
                       int lever_log2) {
  if (piece.size == OutlineSize::kNone || piece.width_mm.raw() <= 0) return 0;
  const std::int32_t width_px = a.width_px.raw() / 2 + b.width_px.raw() / 2;
  const std::int32_t gain = short_quotient(width_px, piece.width_mm.raw(),
                                           lever_log2 + kJacobianFraction + 2);  // to 2^-13
  return -(gain < kMostGain ? gain : kMostGain);
}

SizeEstimate estimate_size(const SizeTest& test, const SizeRow& size) {
  SizeEstimate estimate;
  std::int64_t y[kOutlineUnknowns];  // A^-1 a, Q<30>
  if (size.self <= 0 || !test.system.solve(size.row, y, 30)) return estimate;
  std::int64_t information = size.self, score = size.vector;
  for (int i = 0; i < kOutlineUnknowns; ++i) {
    information -= mul_shift(size.row[i], y[i], 30);
    score -= mul_shift(size.row[i], test.solution[i], 27);
  }
  // A 64th of what it would be with the pose known: hardly told from a pose.
  if (information < size.self >> 6 || information < std::int64_t{1} << 20) return estimate;
  // q = score 2^27 / information, sigma^2 = variance 2^66 / information, Q<30> and Q<60>.
  const std::int64_t limit = 2 * information;  // a quarter of a lever, and no overflow
  if (score > limit) score = limit;
  if (score < -limit) score = -limit;
  const std::int64_t variance = test.variance_q8;
  const auto square = static_cast<std::uint64_t>(
      div_shift(variance < 1 << 16 ? variance : 1 << 16, 46, information >> 20));
  estimate.is_known = true;
  estimate.off_mm = from_lever(div_shift(score, 27, information), test.lever_log2);
  estimate.sigma_mm = from_lever(isqrt(square) + std::int64_t{1}, test.lever_log2);
  return estimate;
}

SizeRow sum_of(const SizeRow& a, const SizeRow& b) {
  SizeRow sum = {};
  for (int i = 0; i < kOutlineUnknowns; ++i) sum.row[i] = a.row[i] + b.row[i];
  sum.self = a.self + b.self;
  sum.vector = a.vector + b.vector;
  return sum;
}

bool has_wrong_size(const SizeEstimate (&sizes)[kOutlineSizes], const TargetModel& target,
                    Mm sigma_mm, Mm widest_mm) {
  constexpr std::int64_t kSure = 6, kLikely = 3;
  const auto is_off = [&](OutlineSize size, Mm dimension, Mm more) {
    const Mm least = part_of(dimension) + more;
    const std::int64_t by = half_sigmas_off(sizes[static_cast<int>(size)], dimension, least);
    return by * by >= kSure * kSure;
  };
  const Mm ring = target.ring_outer_mm - target.ring_inner_mm, radius = mean_radius(target);
  if (is_off(OutlineSize::kDotRadius, radius, of_curvature(radius, sigma_mm)) ||
      is_off(OutlineSize::kRingOuter, ring, Mm(0)) ||
      is_off(OutlineSize::kRingInner, ring, Mm(0))) {
    return true;
  }
  const Mm line = half(target.line_width_mm);
  const SizeEstimate& a = sizes[static_cast<int>(OutlineSize::kFirstWidth)];
  const SizeEstimate& b = sizes[static_cast<int>(OutlineSize::kSecondWidth)];
  if (is_hidden(a, line) || is_hidden(b, line)) {
    return is_off(OutlineSize::kFirstWidth, line, Mm(0)) ||
           is_off(OutlineSize::kSecondWidth, line, Mm(0));
  }
  const std::int64_t by_a = half_sigmas_off(a, line, Mm(0));
  const std::int64_t by_b = half_sigmas_off(b, line, Mm(0));
  return by_a * by_b >= kLikely * kLikely &&
         is_off(OutlineSize::kBothWidths, line, of_shape(line, widest_mm));
}

}  // namespace berth
