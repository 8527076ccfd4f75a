// From descriptions in double to the block: rounding, scaled targets, mountings, refusals.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "block_tools.hpp"

namespace berth::test {
namespace {

template <int F>
double value(Q<F> q) {
  return std::ldexp(q.raw(), -F);
}

host::Target scaled_target(double scale) {
  host::Target target = host::default_target();
  for (double& side : target.plate_size_mm) side *= scale;
  target.ring.outer *= scale, target.ring.inner *= scale;
  for (double& c : target.line.center) c *= scale;
  target.line.length *= scale, target.line.width *= scale;
  for (host::Dot& dot : target.dots) {
    for (double& c : dot.center) c *= scale;
    dot.radius *= scale, dot.collar_radius *= scale, dot.post_radius *= scale;
  }
  return target;
}

TEST(BuildBlock, ValuesAreRoundedToTheNearestStep) {
  const host::Camera camera = host::default_camera();
  const Parameters p = default_parameters();
  EXPECT_NEAR(value(p.camera.cx), camera.cx, std::ldexp(1.0, -17));
  EXPECT_NEAR(value(p.camera.k1), camera.k1, std::ldexp(1.0, -25));
  EXPECT_NEAR(value(p.camera.p2), camera.p2, std::ldexp(1.0, -25));
  EXPECT_EQ(p.target.dots[0].center_mm[2], Mm(-20));
  EXPECT_EQ(p.target.dots[0].collar_radius_mm, Mm(9));
  EXPECT_EQ(p.target.line_y_mm, Mm(45));
  EXPECT_TRUE(p.target.white_on_black);
}

TEST(BuildBlock, TargetsFromAQuarterToFourTimesFit) {
  for (const double scale : {0.25, 0.3, 1.0, 2.5, 4.0}) {
    host::Target target = scaled_target(scale);
    target.white_on_black = false;
    const auto block = host::build_parameter_block(host::default_camera(), target);
    ASSERT_TRUE(block) << block.error();
    Parameters p;
    ASSERT_TRUE(decode_parameter_block(*block, p).is_ok());
    EXPECT_NEAR(value(p.target.dots[1].center_mm[0]), -45 * scale, std::ldexp(1.0, -19));
    EXPECT_FALSE(p.target.white_on_black);
  }
}

TEST(BuildBlock, TargetsBeyondThatAreRefusedInOneLine) {
  const auto huge = host::build_parameter_block(host::default_camera(), scaled_target(80));
  ASSERT_FALSE(huge);
  EXPECT_EQ(
      huge.error(),
      "value out of range: target.plate_width_mm = 9600.000000 does not fit the parameter block");
  const auto large = host::build_parameter_block(host::default_camera(), scaled_target(4.1));
  ASSERT_FALSE(large);
  EXPECT_EQ(large.error(), "value out of range: target.plate_width_mm");
}

TEST(BuildBlock, MoreDotsThanThePoolAreRefused) {
  host::Target target = host::default_target();
  target.dots.resize(9, target.dots.back());
  const auto block = host::build_parameter_block(host::default_camera(), target);
  ASSERT_FALSE(block);
  EXPECT_EQ(block.error(), "value out of range: target.dots has more than 8 dots");
}

TEST(BuildBlock, AnglesAreReducedToHalfATurn) {
  for (const double angle_deg : {0.0, 90.0, 180.0, 270.0, -190.0, 725.0}) {
    host::Target target = host::default_target();
    target.line.length = 20;
    target.line.angle_deg = angle_deg;
    const auto p = host::make_parameters(host::default_camera(), target);
    ASSERT_TRUE(p) << p.error();
    const double angle = value(p->target.line_angle);
    const double wanted = angle_deg * M_PI / 180;
    EXPECT_NEAR(std::remainder(angle - wanted, 2 * M_PI), 0, 4e-9);
  }
}

TEST(BuildBlock, RotationsOfSixDecimalsPassAndComeOutOrthonormal) {
  host::Mount mount;
  const Eigen::Matrix3d r =
      Eigen::AngleAxisd(1.2, Eigen::Vector3d(1, 2, -3).normalized()).toRotationMatrix();
  mount.T_EC.topLeftCorner<3, 3>() = (r * 1e6).array().round() / 1e6;
  mount.T_EC.col(3).head<3>() << 10, -250.5, 80;
  const auto block =
      host::build_parameter_block(host::default_camera(), host::default_target(), mount);
  ASSERT_TRUE(block) << block.error();
  Parameters p;
  ASSERT_TRUE(decode_parameter_block(*block, p).is_ok());
  Eigen::Matrix3d out;
  for (int i = 0; i < 9; ++i)
    out(i / 3, i % 3) = value(p.effector_from_camera.rotation(i / 3, i % 3));
  EXPECT_LT((out - r).cwiseAbs().maxCoeff(), 2e-6);
  EXPECT_LT((out * out.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 4e-9);
  EXPECT_EQ(p.effector_from_camera.translation_mm[1], q<18>(-250.5));
}

TEST(BuildBlock, MountsThatCarryTheToolPoseOutOfItsFormatAreRefused) {
  host::Mount mount;
  mount.T_EC(0, 3) = 3500;
  mount.T_TL(2, 3) = -3000;
  const auto near =
      host::build_parameter_block(host::default_camera(), host::default_target(), mount);
  EXPECT_TRUE(near) << near.error();
  mount.T_TL(2, 3) = -3100;
  const auto far =
      host::build_parameter_block(host::default_camera(), host::default_target(), mount);
  ASSERT_FALSE(far);
  EXPECT_EQ(far.error(), "value out of range: mount.T_EC.translation_mm");
}

TEST(BuildBlock, LinesMustStayOnThePlateAndOffTheRing) {
  host::Target target = host::default_target();
  target.line.angle_deg = 90;
  const auto off_plate = host::build_parameter_block(host::default_camera(), target);
  ASSERT_FALSE(off_plate);
  EXPECT_EQ(off_plate.error(), "value out of range: target.line_length_mm");
  target.line.center = {45, 0};
  EXPECT_TRUE(host::build_parameter_block(host::default_camera(), target));
  target.line.center = {0, 30};
  target.line.angle_deg = 10;
  const auto on_ring = host::build_parameter_block(host::default_camera(), target);
  ASSERT_FALSE(on_ring);
  EXPECT_EQ(on_ring.error(), "value out of range: target.line_center_mm");
}

TEST(BuildBlock, ReflectionsAreRefused) {
  host::Mount mount;
  mount.T_TL(0, 0) = -1;
  const auto block =
      host::build_parameter_block(host::default_camera(), host::default_target(), mount);
  ASSERT_FALSE(block);
  EXPECT_EQ(block.error(), "value out of range: mount.T_TL.rotation");
}

TEST(BuildBlock, EqualInputsGiveEqualBytes) {
  const auto once = host::build_parameter_block(host::default_camera(), host::default_target());
  const auto again = host::build_parameter_block(host::default_camera(), host::default_target());
  EXPECT_EQ(*once, *again);
}

}  // namespace
}  // namespace berth::test
