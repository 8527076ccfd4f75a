// Stage 2b: an ellipse, and its least-squares fit to edge pixels.
//
// An ellipse is kept as the affine frame in which it is the unit circle: q = M (p - c), |q| = 1.
// The algebraic fit A x^2 + B x y + C y^2 + D x + E y = 1 is done in the frame of the previous
// estimate, where all points lie near the unit circle: there the algebraic distance equals the
// geometric one to first order in units of the local radius, so that repeated fits come close to
// the orthogonal fit (bias of order noise^2) at the price of a 5 x 5 linear system.
#pragma once

#include <cstdint>

#include "circle/conic_system.hpp"
#include "fixed/q.hpp"

namespace berth {

struct Ellipse {
  Px cx, cy;      // centre, grid cells
  Q<26> m[2][2];  // per cell: 1/512 .. 1, so |entries| < 2

  static Ellipse circle(Px x, Px y, Px radius);
};

/// Extent and axes of an ellipse, cells.
struct EllipseAxes {
  Px major, minor;             // semi-axes
  Px half_width, half_height;  // of the bounding box
};

/// False when the frame is singular or a semi-axis exceeds `limit`.
bool measure_axes(const Ellipse& ellipse, Px limit, EllipseAxes& axes);

/// Point of the ellipse at parameter (cos, sin): c + M^-1 (cos, sin).
struct EllipsePoint {
  Px x, y;
};
EllipsePoint point_at(const Ellipse& ellipse, Unit cosine, Unit sine);

/// Where a point lies in the frame of an ellipse, for gating: 12 fraction bits, |q| < 8.
struct FramePoint {
  std::int32_t x, y;
};

/// The frame of an ellipse as the integers that gating and fitting use; `frame` holds exactly the
/// rounded M, so that no precision is lost between fit and update.
struct EllipseFrame {
  std::int32_t cx, cy;   // centre, 1/64 cell
  std::int32_t m[2][2];  // 16 fraction bits, per cell

  explicit EllipseFrame(const Ellipse& ellipse);
  /// x, y in 1/64 cell, within 512 cells of the centre.
  FramePoint map(std::int32_t x, std::int32_t y) const {
    const std::int64_t dx = x - cx, dy = y - cy;
    return {static_cast<std::int32_t>((m[0][0] * dx + m[0][1] * dy) >> 10),
            static_cast<std::int32_t>((m[1][0] * dx + m[1][1] * dy) >> 10)};
  }
};

/// Sums of a fit; add() each point, then solve.
class EllipseFit {
 public:
  /// |q| < 2.
  void add(FramePoint q) { system_.add(q.x, q.y); }
  int count() const { return system_.count(); }
  /// The ellipse that fits best, given the frame the points were mapped with. False when the points
  /// do not determine an ellipse.
  bool solve(const EllipseFrame& frame, Ellipse& ellipse);

 private:
  ConicSystem system_;
};

}  // namespace berth
