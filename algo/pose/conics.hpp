// Intersection of two conics: the degenerate member of their pencil, split into two lines.
//
//   det(A + g B) = 0,  A + g B = (l m^T + m l^T) / 2;  p^T A p = 0 on l and on m
//
// Splitting by the adjugate: Richter-Gebert, Perspectives on Projective Geometry (2011), 11.1.
#pragma once

#include "fixed/scaled.hpp"

namespace berth {

/// Symmetric 3 x 3 matrix over the homogeneous coordinates (s, x, y).
struct Conic {
  Scaled ss, sx, sy, xx, xy, yy;
};

/// A homogeneous point, or the coefficients of a line.
struct ConicPoint {
  Scaled s, x, y;
};

struct Intersections {
  int count = 0;
  ConicPoint point[4];
};

/// wa a + wb b.
Conic combine(const Conic& a, const Scaled& wa, const Conic& b, const Scaled& wb);

/// p^T c q.
Scaled quadratic_form(const Conic& c, const ConicPoint& p, const ConicPoint& q);

/// The real common points of two conics, a nearly real pair (discriminant above -2^-7 of the
/// form's squared norm)
/// as its midpoint. None when the pencil has no member with real lines, or is singular throughout.
/// Exact to about 2^-50 where the points are distinct. Cost: about 40 000 instructions.
Intersections intersect(const Conic& a, const Conic& b);

}  // namespace berth
