// Perspective-three-point: three bearings and three target points to at most four poses.
//
//   |s_i f_i - s_j f_j| = d_ij for (i, j) = (1,2), (1,3), (2,3), with f unit bearings
//
// Source: Ding, Yang, Larsson, Olsson, Astrom, "Revisiting the P3P Problem", CVPR 2023 (two conics,
// the degenerate member of their pencil, two lines, up to four intersections), after Persson and
// Nordberg, "Lambda Twist", ECCV 2018. Departures, for a narrow field and bad geometry:
// - The unknowns are s_1 and the differences s_2 - s_1, s_3 - s_1, the coefficients the squared
//   chords |f_i - f_j|^2: no cosine close to 1 is ever subtracted from another.
// - Of the pencil's cubic the root farthest from its inflection is taken. It is simple also where
//   two poses coincide (danger cylinder), where the lines stay well determined.
// - A slightly negative discriminant on a line is a double root: the tangent point is a candidate.
// - Newton steps on the three equations end it; one that does not reduce the residual is undone.
#pragma once

#include "core/reason.hpp"
#include "pose/pose.hpp"

namespace berth {

/// Three correspondences; bearings are unit vectors (to 2^-28) of the camera frame with z > 0.
struct PointTriple {
  Vec3Unit bearing[3];
  Vec3Mm point_mm[3];
};

struct P3pResult {
  Reason reason = Reason::kNoSolution;
  std::int32_t count = 0;
  RigidTransform camera_from_target[4];  // all three points in front of the camera
};

/// kNone with 1 to 4 poses; kDegenerate for coincident or collinear points (sine of an angle of the
/// triangle below 0.01), or bearings closer than 2^-10 rad; kNoSolution where no pose with all
/// points in front of the camera and within the range of Mm explains them.
/// Any lengths within Mm. Cost: about 100 000 instructions; 1.5 KiB of stack.
P3pResult solve_p3p(const PointTriple& triple);

}  // namespace berth
