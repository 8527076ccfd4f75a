#include "target/verify_layout.hpp"

#include "fixed/roots.hpp"
#include "fixed/trigonometry.hpp"
#include "target/identify.hpp"
#include "target/verify_sizes.hpp"

namespace berth {
namespace {

constexpr int kPoints = 16;
constexpr int kOne = 4096;  // 1 in the ellipse's frame
constexpr Angle kMaxTurn = q<28>(0.07);

Px to_cell(Px frame, int origin, int bin) {
  return Px::from_wide((std::int64_t{frame.raw()} - origin * 65536 - (bin - 1) * 32768) / bin);
}

// Mean |q| of the predicted outline in the frame of the measured one: 1 when they are of one size.
int relative_size(const TargetView& view, Mm radius, const SearchGrid& grid,
                  const RingCandidate& ring) {
  const EllipseFrame frame(ring.ellipse);
  std::int64_t sum = 0;
  for (int k = 0; k < kPoints; ++k) {
    const SinCos turn = sin_cos(part_of_turn(k, kPoints));
    const Vec2Px at = view.pixel(radius * turn.cos, radius * turn.sin);
    const FramePoint q = frame.map(to_cell(at[0], grid.x0, grid.bin).to<6>().raw(),
                                   to_cell(at[1], grid.y0, grid.bin).to<6>().raw());
    sum += hypot(q.x, q.y);
  }
  return static_cast<int>(sum / kPoints);
}

}  // namespace

bool is_ring_of_size(const TargetView& view, const TargetModel& target, const SearchGrid& grid,
                     const RingCandidate& ring) {
  const int size = relative_size(view, apparent_radius(target, ring), grid, ring);
  const int minor_px = ring.axes.minor.round() > 0 ? ring.axes.minor.round() * grid.bin : 1;
  const int tolerance = kOne / 20 + kOne * 4 / 5 / minor_px;
  return size <= kOne + tolerance && size >= kOne - tolerance;
}

LayoutCheck check_layout(const TargetView& view, const TargetModel& target,
                         const ReferenceValues& reference, std::uint16_t noise_q8) {
  const LineTest line = test_line(view, target, reference, noise_q8);
  const Mm reach = Mm::from_wide(std::int64_t{target.line_width_mm.raw()} * 37 / 100);
  if (!line.is_line || abs(line.offset_mm) >= reach || abs(line.turn) >= kMaxTurn) return {};
  const Sizes sizes = measure_sizes(view, target, reference, noise_q8);
  return {are_sizes_consistent(sizes), sizes.sigma_mm};
}

}  // namespace berth
