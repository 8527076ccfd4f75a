// Are the outlines as large as the target's? A score test for each dimension, from the refinement's
// last equations.
//
// A tenth unknown q moves the outlines of one dimension outwards. With A x = b of pose and edge
// offset, q's row a, its diagonal d and right-hand side g, the sectors' levels eliminated from all,
//
//   s = d - a^T A^-1 a,   q = (g - a^T A^-1 b) / s,   var q = variance / s
//
// is the least squares estimate of q beside all others (Rao 1948; Schur complement). Every pixel of
// an outline counts, so it sees a tenth of a pixel where profiles across it see half of one; and
// what gamma does to all edges is taken up by the edge offset.
#pragma once

#include <cstdint>

#include "fixed/linear.hpp"
#include "pose/outline_normal.hpp"
#include "target/model.hpp"

namespace berth {

/// How far the outlines of a dimension lie outside their places, on the plate; of line width and
/// length each of two edges.
struct SizeEstimate {
  bool is_known = false;
  Mm off_mm, sigma_mm;
};

/// Pixels that an outline moves by for each lever of its dimension, along the normal towards white:
/// Q<5>, not positive, as outwards is away from white.
std::int32_t size_gain(const OutlinePiece& piece, const OutlineVertex& a, const OutlineVertex& b,
                       int lever_log2);

/// What the solution of the equations asks of every size's row.
struct SizeTest {
  const SpdSystem<kOutlineUnknowns>& system;  // A, factored
  std::int64_t solution[kOutlineUnknowns];    // x, Q<30>
  std::int64_t variance_q8;                   // of a pixel, DN^2
  int lever_log2;
};

/// Both sizes by the same amount.
SizeRow sum_of(const SizeRow& a, const SizeRow& b);

/// Unknown where no outline of the dimension was measured or the pose takes up all but a 64th of
/// what it knows. Cost: 15,000 instructions.
SizeEstimate estimate_size(const SizeTest& test, const SizeRow& size);

/// Whether outlines are off by more than 4 % of their dimension (the dots' radius, the ring's
/// width, half of the line's) and 3 sigma. Of the line it is both halves together, if each is off
/// the same way by 1.5 sigma, or the one that is seen where something hides the other. Near misses
/// are off by 10 % and more, of which robust weights and the edge offset take a part. Targets (760
/// of all conditions, gamma 0.45 to 2.2, Gaussian, disc and box point spreads) stay below 3.2 %, or
/// their sigma is more than a percent. `sigma_mm`, of the blur: dots of 2.6 sigma are seen 7 %
/// smaller under a gamma of 2.2, of 4 sigma 3 % larger under a disc, so that they may be off by
/// sigma^2 / 2 r more; a line as wide as 3 sigma is seen 4 % wider in motion, and may be off by
/// sigma^2 / 16 w more, w half of its width and sigma the `widest_mm`: where tilt foreshortens the
/// plate.
bool has_wrong_size(const SizeEstimate (&sizes)[kOutlineSizes], const TargetModel& target,
                    Mm sigma_mm, Mm widest_mm);

}  // namespace berth
