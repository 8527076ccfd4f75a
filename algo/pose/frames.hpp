// Rotations, rigid transforms and the way of a pose and its covariance into the arm's frames.
//
//   T_EL = T_EC T_CT T_TL
//
// Covariances are of (delta, dt), R_est = exp(delta) R_true, in the axes of the first frame. With
// l = R_EC R_CT t_TL, the lever from the target to the latch in E, an error of T_CT becomes
//   delta_E = R_EC delta,  dt_E = R_EC dt + (R_EC delta) x l        (the adjoint of T_EC, moved by
//   l)
// an error of T_EC      delta_E = delta,       dt_E = dt + delta x (R_EC t_CL)
// an error of T_TL      delta_E = R_ET delta,  dt_E = R_ET dt
// and the three are independent.
#pragma once

#include "pose/pose.hpp"

namespace berth {

/// Hamilton quaternion of a rotation (orthonormal to 2^-20), by its largest component (Shepperd
/// 1978). Norm 1 to 2^-29; w >= 0, and where w is 0 the first other component is positive.
Quaternion quaternion_of(const Mat3Unit& rotation);

/// Rotation of a quaternion, which is normalised on the way: any norm but 0. Error below 2^-30.
Mat3Unit rotation_of(const Quaternion& quaternion);

/// The nearest rotation, by Newton's iteration R <- R (3 I - R^T R) / 2 (Higham 1986).
/// Precondition: |R^T R - I| < 0.1 by its entries. Orthonormal to 2^-29 afterwards. Cost: about
/// 1500.
Mat3Unit orthonormalize(const Mat3Unit& rotation);

/// Products of rotations, not re-normalised. Error 2^-31 per entry.
Mat3Unit compose(const Mat3Unit& a, const Mat3Unit& b);

/// a_from_c = a_from_b * b_from_c. |translation| within the range of Mm, saturated beyond.
RigidTransform compose(const RigidTransform& a_from_b, const RigidTransform& b_from_c);

/// b_from_a.
RigidTransform inverse(const RigidTransform& a_from_b);

/// The three transforms of the chain.
struct FrameChain {
  RigidTransform effector_from_camera;  // T_EC
  RigidTransform camera_from_target;    // T_CT
  RigidTransform target_from_latch;     // T_TL
};

/// Their covariances; a null pointer is an exactly known transform.
struct ChainCovariance {
  const PoseCovariance* effector_from_camera = nullptr;
  const PoseCovariance* camera_from_target = nullptr;
  const PoseCovariance* target_from_latch = nullptr;
};

/// T_EL.
RigidTransform effector_from_latch(const FrameChain& chain);

/// Covariance of T_EL. Sigmas saturate at the range of their formats. Cost: about 80 000
/// instructions per given covariance; 3 KiB of stack.
PoseCovariance transport_covariance(const FrameChain& chain, const ChainCovariance& covariance);

}  // namespace berth
