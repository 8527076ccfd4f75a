#include "target/ring_pose.hpp"

#include <Eigen/Geometry>

#include "camera/projection.hpp"
#include "fixed/linear.hpp"
#include "fixed/roots.hpp"
#include "fixed/wide.hpp"

namespace berth {
namespace {

// Rays are fitted in cells of 1/1024 (about a pixel), so that the ellipse fit's ranges hold.
constexpr int kRayCellShift = 10;
constexpr int kOutlinePoints = 16;

struct Turn {
  Unit cosine, sine;
};

// cos and sin of 22.5 k degrees.
constexpr Unit kC1 = q<30>(0.923879532511287), kS1 = q<30>(0.382683432365090);
constexpr Unit kC2 = q<30>(0.707106781186548);
constexpr Turn kTurns[kOutlinePoints] = {
    {Unit(1), Unit(0)},  {kC1, kS1},   {kC2, kC2},   {kS1, kC1},
    {Unit(0), Unit(1)},  {-kS1, kC1},  {-kC2, kC2},  {-kC1, kS1},
    {-Unit(1), Unit(0)}, {-kC1, -kS1}, {-kC2, -kC2}, {-kS1, -kC1},
    {Unit(0), -Unit(1)}, {kS1, -kC1},  {kC2, -kC2},  {kC1, -kS1}};

Px to_cells(Ray r) { return Px::from_wide(shift_round(r.raw(), 28 - 16 - kRayCellShift)); }

// The outline in undistorted rays, as an ellipse in ray cells.
bool undistort_ellipse(const Camera& camera, const SearchGrid& grid, const Ellipse& ellipse,
                       Ellipse& rays) {
  const auto ray_at = [&](Px x, Px y) {
    return undistort(camera, Vec2Px(grid.to_frame_x(x), grid.to_frame_y(y)));
  };
  const Vec2Ray center = ray_at(ellipse.cx, ellipse.cy);
  rays.cx = to_cells(center[0]);
  rays.cy = to_cells(center[1]);
  // First guess of the frame: the ellipse's own, scaled from grid cells to ray cells.
  const Q<16> scale = Q<16>::from_wide((std::int64_t{camera.fx.raw()} / grid.bin) >> kRayCellShift);
  for (int i = 0; i < 2; ++i) {
    for (int k = 0; k < 2; ++k) rays.m[i][k] = mul<26>(ellipse.m[i][k], scale);
  }
  const EllipseFrame frame(rays);
  EllipseFit fit;
  for (const Turn& t : kTurns) {
    const EllipsePoint p = point_at(ellipse, t.cosine, t.sine);
    const Vec2Ray r = ray_at(p.x, p.y);
    const FramePoint at = frame.map(to_cells(r[0]).to<6>().raw(), to_cells(r[1]).to<6>().raw());
    if (at.x > 8000 || at.x < -8000 || at.y > 8000 || at.y < -8000) return false;
    fit.add(at);
  }
  return fit.solve(frame, rays);
}

// The cone [A, -A c; -c^T A, c^T A c - b^2] with A = b^2 M^T M, b the minor semi-axis: |A| <= 1.
bool cone_of(const Ellipse& rays, Mat3Unit& cone) {
  EllipseAxes axes;
  if (!measure_axes(rays, Px(1024), axes) || axes.minor < Px(1)) return false;
  std::int64_t n[2][2];  // b M, 28 fraction bits
  for (int i = 0; i < 2; ++i) {
    for (int k = 0; k < 2; ++k) {
      n[i][k] = shift_round(std::int64_t{rays.m[i][k].raw()} * axes.minor.raw(), 26 + 16 - 28);
    }
  }
  const auto entry = [&](int i, int k) {
    return Unit::saturated(shift_round(n[0][i] * n[0][k] + n[1][i] * n[1][k], 56 - 30));
  };
  // cells / 1024 in Unit: raw 2^-16 cells = 2^-26, so 4 more bits.
  const auto ray_of = [](Px cells) {
    return Unit::saturated(shift_by(cells.raw(), 30 - 16 - kRayCellShift));
  };
  const Unit cx = ray_of(rays.cx), cy = ray_of(rays.cy), b = ray_of(axes.minor);
  const Unit xx = entry(0, 0), xy = entry(0, 1), yy = entry(1, 1);
  const Unit px = xx * cx + xy * cy, py = xy * cx + yy * cy;
  cone << xx, xy, -px, xy, yy, -py, -px, -py, px * cx + py * cy - b * b;
  return true;
}

struct ConeShape {
  Unit g, h;
  Q<20> far;  // sqrt(l1 / -l3)
  Unit near;  // sqrt(-l3 / l1)
};

bool shape_of(const SymmetricEigen3& eigen, ConeShape& shape) {
  const std::int64_t l1 = eigen.values[0].raw(), l2 = eigen.values[1].raw(),
                     l3 = eigen.values[2].raw();
  if (l2 <= 0 || l3 >= 0 || l1 <= 0) return false;
  const auto root_of = [](std::int64_t part, std::int64_t whole) {
    const std::int64_t ratio = div_shift(part, 60, whole);  // 60 fraction bits, 0..1
    return Unit::saturated(isqrt_nearest(static_cast<std::uint64_t>(ratio)));
  };
  shape.h = root_of(l1 - l2, l1 - l3);
  shape.g = root_of(l2 - l3, l1 - l3);
  shape.near = root_of(-l3, l1);
  if (shape.near.raw() < (1 << 18)) return false;  // a circle of less than 0.015 degrees
  shape.far = Q<20>::saturated((std::int64_t{1} << 50) / shape.near.raw());
  return true;
}

}  // namespace

bool solve_ring_pose(const Camera& camera, const SearchGrid& grid, const Ellipse& ellipse,
                     Mm radius_mm, PlatePose (&poses)[2]) {
  Ellipse rays;
  Mat3Unit cone;
  if (!undistort_ellipse(camera, grid, ellipse, rays) || !cone_of(rays, cone)) return false;
  const SymmetricEigen3 eigen = decompose_symmetric(cone);
  ConeShape shape;
  if (!shape_of(eigen, shape)) return false;
  Vec3Unit e1 = eigen.vectors.col(0), e3 = eigen.vectors.col(2);
  if (e3[2].raw() < 0) e3 = -e3;
  // Beyond the range of lengths (8 m) the ring is none of ours.
  const std::int64_t distance = shift_round(std::int64_t{radius_mm.raw()} * shape.far.raw(), 20);
  if (distance >= (std::int64_t{1} << 31)) return false;
  const Mm along_axis = Mm::from_wide(distance) * shape.g;
  const Mm across = radius_mm * shape.near * shape.h;
  for (int s = 0; s < 2; ++s) {
    if (s == 1) e1 = -e1;
    const Vec3Unit n = e1 * shape.h + e3 * shape.g;
    // Any unit vector in the plate: e2 is one, n x e2 the other.
    const Vec3Unit u = eigen.vectors.col(1);
    poses[s].basis.col(0) = u;
    poses[s].basis.col(1) = n.cross(u);
    poses[s].basis.col(2) = n;
    for (int k = 0; k < 3; ++k) {
      poses[s].center_mm[k] = along_axis * e3[k] - across * e1[k];
    }
    if (poses[s].center_mm[2].raw() <= 0) return false;
  }
  return true;
}

RigidTransform with_roll(const PlatePose& plate, Unit cosine, Unit sine) {
  RigidTransform t;
  const Vec3Unit u = plate.basis.col(0), v = plate.basis.col(1);
  t.rotation.col(0) = u * cosine + v * sine;
  t.rotation.col(1) = v * cosine - u * sine;
  t.rotation.col(2) = plate.basis.col(2);
  t.translation_mm = plate.center_mm;
  return t;
}

}  // namespace berth
