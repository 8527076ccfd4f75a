#include "scenes.hpp"

#include <cmath>

namespace berth::test {
namespace {

template <int F>
Q<F> fix(double value) {
  return Q<F>::saturated(std::llround(std::ldexp(value, F)));
}
template <int F>
double real(Q<F> value) {
  return std::ldexp(static_cast<double>(value.raw()), -F);
}

Eigen::Matrix3d turn(double angle, const Eigen::Vector3d& axis) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

// Area and centroid of the projected polygon of a plane outline.
struct Area {
  double area = 0;
  Eigen::Vector2d moment = Eigen::Vector2d::Zero();
};

template <typename Outline>
Area polygon(const CameraD& camera, const PoseD& pose, int n, const Outline& outline) {
  Area sum;
  const auto at = [&](int i) {
    return project(camera, pose.rotation * outline(i % n) + pose.translation_mm);
  };
  const Eigen::Vector2d origin = at(0);
  Eigen::Vector2d last = Eigen::Vector2d::Zero();
  for (int i = 1; i <= n; ++i) {
    const Eigen::Vector2d next = at(i) - origin;
    const double doubled = last.x() * next.y() - last.y() * next.x();
    sum.area += doubled / 2;
    sum.moment += (last + next) * doubled / 6;
    last = next;
  }
  sum.moment += origin * sum.area;
  return sum;
}

Area circle(const CameraD& camera, const PoseD& pose, const Eigen::Vector3d& center,
            double radius) {
  const int n = 1024;  // centroid right to 1e-5 of its bias
  return polygon(camera, pose, n, [&](int i) {
    const double a = 2 * M_PI * i / n;
    return Eigen::Vector3d(center + radius * Eigen::Vector3d(std::cos(a), std::sin(a), 0));
  });
}

Area bar(const CameraD& camera, const PoseD& pose, const TargetModel& target) {
  const double l = real(target.line_length_mm) / 2, w = real(target.line_width_mm) / 2;
  const Eigen::Vector3d center(real(target.line_x_mm), real(target.line_y_mm), 0);
  const Eigen::Matrix3d turned = turn(real(target.line_angle), Eigen::Vector3d::UnitZ());
  const Eigen::Vector3d corners[4] = {{-l, -w, 0}, {l, -w, 0}, {l, w, 0}, {-l, w, 0}};
  const int per_side = 256;
  return polygon(camera, pose, 4 * per_side, [&](int i) {
    const int side = i / per_side;
    const double f = (i % per_side) / static_cast<double>(per_side);
    return Eigen::Vector3d(center +
                           turned * ((1 - f) * corners[side] + f * corners[(side + 1) % 4]));
  });
}

}  // namespace

CameraD ideal_camera() { return {}; }
CameraD hec1_camera() {
  CameraD camera;
  camera.k1 = -0.12, camera.k2 = 0.08, camera.p1 = 0.0002, camera.p2 = -0.0003;
  return camera;
}

Camera to_fixed(const CameraD& c) {
  Camera camera;
  camera.width = camera.height = 1024;
  camera.fx = fix<16>(c.fx), camera.fy = fix<16>(c.fy);
  camera.cx = fix<16>(c.cx), camera.cy = fix<16>(c.cy);
  camera.k1 = fix<24>(c.k1), camera.k2 = fix<24>(c.k2), camera.k3 = fix<24>(c.k3);
  camera.p1 = fix<24>(c.p1), camera.p2 = fix<24>(c.p2);
  return camera;
}

PoseD to_double(const RigidTransform& pose) {
  PoseD out;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) out.rotation(i, k) = real(pose.rotation(i, k));
    out.translation_mm[i] = real(pose.translation_mm[i]);
  }
  return out;
}

RigidTransform to_fixed(const PoseD& pose) {
  RigidTransform out;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) out.rotation(i, k) = fix<30>(pose.rotation(i, k));
    out.translation_mm[i] = fix<18>(pose.translation_mm[i]);
  }
  return out;
}

TargetModel ct1(double scale, bool is_flat) {
  const auto mm = [scale](double value) { return fix<18>(value * scale); };
  TargetModel target;
  target.plate_width_mm = target.plate_height_mm = mm(120);
  target.ring_outer_mm = mm(30), target.ring_inner_mm = mm(24);
  target.line_x_mm = Mm(0), target.line_y_mm = mm(45);
  target.line_length_mm = mm(56), target.line_width_mm = mm(6);
  const auto add = [&](double x, double y, double z) {
    Dot& dot = target.dots[target.dot_count++];
    dot.center_mm = {mm(x), mm(y), mm(z)};
    dot.radius_mm = mm(6);
  };
  if (!is_flat) add(0, 0, -20);
  add(-45, -45, 0), add(45, -45, 0), add(-45, 45, 0), add(45, 45, 0);
  return target;
}

Eigen::Vector2d project(const CameraD& c, const Eigen::Vector3d& point_mm) {
  const double x = point_mm.x() / point_mm.z(), y = point_mm.y() / point_mm.z();
  const double r2 = x * x + y * y, d = 1 + r2 * (c.k1 + r2 * (c.k2 + r2 * c.k3));
  const double xd = x * d + 2 * c.p1 * x * y + c.p2 * (r2 + 2 * x * x);
  const double yd = y * d + c.p1 * (r2 + 2 * y * y) + 2 * c.p2 * x * y;
  return {c.fx * xd + c.cx, c.fy * yd + c.cy};
}

Eigen::Vector2d undistort(const CameraD& camera, const Eigen::Vector2d& pixel) {
  Eigen::Vector2d ray((pixel.x() - camera.cx) / camera.fx, (pixel.y() - camera.cy) / camera.fy);
  for (int i = 0; i < 40; ++i) {  // contraction: the distortion is weak
    const Eigen::Vector2d error = pixel - project(camera, ray.homogeneous());
    ray += Eigen::Vector2d(error.x() / camera.fx, error.y() / camera.fy);
  }
  return ray;
}

Eigen::Vector3d dot_center(const TargetModel& target, int index) {
  const Vec3Mm& c = target.dots[index].center_mm;
  return {real(c[0]), real(c[1]), real(c[2])};
}

Eigen::Vector2d area_centroid(const CameraD& camera, const PoseD& pose, const TargetModel& target,
                              MarkerKind kind, int index) {
  Area area;
  if (kind == MarkerKind::kDot) {
    area = circle(camera, pose, dot_center(target, index), real(target.dots[index].radius_mm));
  } else if (kind == MarkerKind::kLine) {
    area = bar(camera, pose, target);
  } else {
    area = circle(camera, pose, Eigen::Vector3d::Zero(), real(target.ring_outer_mm));
    const Area hole = circle(camera, pose, Eigen::Vector3d::Zero(), real(target.ring_inner_mm));
    area.area -= hole.area;
    area.moment -= hole.moment;
  }
  return area.moment / area.area;
}

double rotation_error_rad(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  const Eigen::Matrix3d r = a * b.transpose();
  const Eigen::Vector3d twice_sine(r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1));
  return std::atan2(twice_sine.norm(), r.trace() - 1);
}

Bound clean_bound(const PoseD& pose, double scale) {
  const double distance[5] = {300, 500, 800, 1100, 1500};
  const double rotation[2][5] = {{0.00141, 0.0037, 0.0084, 0.0141, 0.0233},
                                 {0.00076, 0.0017, 0.0035, 0.0056, 0.0090}};
  const double translation[2][5] = {{0.00083, 0.0029, 0.0094, 0.0210, 0.0459},
                                    {0.00130, 0.0050, 0.0166, 0.0375, 0.0829}};
  const double z = std::min(1500.0, std::max(300.0, pose.translation_mm.norm() / scale));
  int i = 0;
  while (i < 3 && z > distance[i + 1]) ++i;
  const double f = std::log(z / distance[i]) / std::log(distance[i + 1] / distance[i]);
  const double g = std::min(1.0, pose.tilt_rad / (40 * M_PI / 180));
  const auto at = [&](const double(&table)[2][5]) {
    double end[2];
    for (int k = 0; k < 2; ++k) {
      end[k] = std::exp((1 - f) * std::log(table[k][i]) + f * std::log(table[k][i + 1]));
    }
    return (1 - g) * end[0] + g * end[1];
  };
  return {at(rotation) * M_PI / 180, at(translation) * scale};
}

double Envelope::uniform(double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random_);
}
double Envelope::normal() { return std::normal_distribution<double>()(random_); }

PoseD Envelope::draw(const CameraD& camera, double scale) {
  const double distance = scale * std::exp(uniform(std::log(300.0), std::log(1500.0)));
  return draw_at(camera, distance, uniform(0, 40 * M_PI / 180), scale);
}

PoseD Envelope::draw_at(const CameraD& camera, double distance_mm, double tilt_rad, double scale) {
  for (;;) {
    const Eigen::Vector2d ray = undistort(camera, {uniform(0, 1023), uniform(0, 1023)});
    const Eigen::Vector3d view = ray.homogeneous().normalized();
    const Eigen::Matrix3d facing =
        Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), view).toRotationMatrix();
    const double direction = uniform(0, 2 * M_PI), roll = uniform(0, 2 * M_PI);
    PoseD pose;
    pose.tilt_rad = tilt_rad;
    pose.translation_mm = distance_mm * view;
    pose.rotation = facing * turn(tilt_rad, {std::cos(direction), std::sin(direction), 0}) *
                    turn(roll, Eigen::Vector3d::UnitZ());
    bool is_inside = true;
    for (int i = 0; i < 4; ++i) {
      const Eigen::Vector3d corner(i % 2 ? 60 : -60, i / 2 ? 60 : -60, 0);
      const Eigen::Vector2d pixel =
          project(camera, pose.rotation * (scale * corner) + pose.translation_mm);
      is_inside = is_inside && pixel.minCoeff() >= 0 && pixel.maxCoeff() <= 1023;
    }
    if (is_inside) return pose;
  }
}

namespace {

void set_measured(Marker& marker, const Eigen::Vector2d& center_px, double sigma_px) {
  marker.located = true;
  marker.center_px = {fix<16>(center_px.x()), fix<16>(center_px.y())};
  marker.variance_xx = marker.variance_yy = fix<24>(sigma_px * sigma_px);
  marker.variance_xy = Q<24>(0);
}

}  // namespace

MarkerSet markers_at(const TargetModel& target, const std::vector<Eigen::Vector2d>& dots_px,
                     double sigma_px) {
  MarkerSet set;
  for (int i = 0; i < target.dot_count; ++i) {
    Marker& marker = set.markers[set.count++];
    marker.kind = MarkerKind::kDot;
    marker.index = static_cast<std::uint8_t>(i);
    set_measured(marker, dots_px[static_cast<std::size_t>(i)], sigma_px);
  }
  return set;
}

void add_marker(MarkerSet& set, MarkerKind kind, const Eigen::Vector2d& center_px,
                double sigma_px) {
  Marker& marker = set.markers[set.count++];
  marker.kind = kind;
  set_measured(marker, center_px, sigma_px);
}

}  // namespace berth::test
