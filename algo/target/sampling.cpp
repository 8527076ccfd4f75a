// See sampling.hpp.
#include "target/sampling.hpp"

#include "fixed/wide.hpp"

namespace berth {
namespace {

// Rotation by product: each of the products is rounded, as Eigen's are.
[[gnu::always_inline]] inline Vec3Mm face_point(const RigidTransform& t, Mm x, Mm y) {
  BERTH_RANGE(abs(x) < Mm(2048) && abs(y) < Mm(2048));
  Vec3Mm p;
  for (int i = 0; i < 3; ++i) {
    p[i] = Mm::from_raw(multiply_high(t.rotation(i, 0).raw(), 4 * x.raw())) +
           Mm::from_raw(multiply_high(t.rotation(i, 1).raw(), 4 * y.raw())) + t.translation_mm[i];
  }
  return p;
}

}  // namespace

Vec2Px TargetView::pixel(Mm x, Mm y) const {
  return project(camera, face_point(camera_from_target, x, y));
}

Vec2Px TargetView::pixel(const Vec3Mm& p) const {
  Vec3Mm point = face_point(camera_from_target, p[0], p[1]);
  for (int i = 0; i < 3; ++i) point[i] += camera_from_target.rotation(i, 2) * p[2];
  return project(camera, point);
}

}  // namespace berth
