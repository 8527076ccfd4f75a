#include "accuracy/bound.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "host_sim/render/outline.hpp"
#include "host_sim/render/render.hpp"

namespace berth::accuracy {
namespace {

constexpr double kPi = 3.14159265358979323846;

std::vector<float> image_of(const host::Scene& scene, const host::Camera& camera,
                            const host::Target& target) {
  std::vector<float> image;
  host::render(scene, camera, target, image);
  return image;
}

struct Difference {
  host::Scene low, high;
  double step;  // high - low
};

std::vector<Difference> differences(const host::Scene& scene) {
  std::vector<Difference> all;
  for (int i = 0; i < 6; ++i) {
    // A tenth of a pixel or less at the target's rim.
    Vector6 step = Vector6::Zero();
    step[i] = (i < 3 ? 1e-4 : 4e-5 * scene.pose.t.norm()) * (i == 5 ? 3 : 1);
    Difference d{scene, scene, 2 * step[i]};
    d.low.pose = moved(scene.pose, -step);
    d.high.pose = moved(scene.pose, step);
    all.push_back(d);
  }
  Difference white{scene, scene, 2.0}, black{scene, scene, 2.0}, blur{scene, scene, 0.04};
  white.low.light.white_dn -= 1;
  white.high.light.white_dn += 1;
  black.low.light.black_dn -= 1;
  black.high.light.black_dn += 1;
  black.low.background.level_dn -= 1;
  black.high.background.level_dn += 1;
  blur.low.optics.defocus_px -= 0.02;
  blur.high.optics.defocus_px += 0.02;
  all.push_back(white);
  all.push_back(black);
  all.push_back(blur);
  return all;
}

using Place = std::function<Eigen::Vector3d(double)>;  // 0 <= s <= 1 along an outline, target frame

struct Outline {
  Place at;
  double width_mm;
  int steps;
};

std::vector<Outline> outlines_of(const host::Target& target) {
  std::vector<Outline> all;
  const auto circle = [](std::array<double, 3> c, double r) {
    return Place([=](double s) {
      return Eigen::Vector3d(c[0] + r * std::cos(2 * kPi * s), c[1] + r * std::sin(2 * kPi * s),
                             c[2]);
    });
  };
  for (const host::Dot& dot : target.dots) {
    all.push_back({circle(dot.center, dot.radius), 2 * dot.radius, 120});
  }
  const double ring_width = target.ring.outer - target.ring.inner;
  all.push_back({circle({0, 0, 0}, target.ring.outer), ring_width, 360});
  all.push_back({circle({0, 0, 0}, target.ring.inner), ring_width, 360});
  const auto corners = host::rectangle_corners(
      target.line.center, target.line.length, target.line.width, target.line.angle_deg * kPi / 180);
  for (size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d a(corners[i].data()), b(corners[(i + 1) % corners.size()].data());
    const double length = (b - a).norm();
    all.push_back({[=](double s) {
                     const Eigen::Vector2d p = a + s * (b - a);
                     return Eigen::Vector3d(p.x(), p.y(), 0);
                   },
                   length > target.line.width ? target.line.width : target.line.length, 60});
  }
  return all;
}

// Where the sight line to p crosses the plane at depth z.
Eigen::Vector2d seen_through(const Eigen::Vector3d& eye, const Eigen::Vector3d& p, double z) {
  const double s = (z - p.z()) / (eye.z() - p.z());
  return (p + s * (eye - p)).head<2>();
}

bool is_inside(const std::vector<std::array<double, 2>>& polygon, const Eigen::Vector2d& q) {
  bool inside = false;
  for (size_t i = 0, k = polygon.size() - 1; i < polygon.size(); k = i++) {
    const auto& a = polygon[i];
    const auto& b = polygon[k];
    if ((a[1] > q.y()) == (b[1] > q.y())) continue;
    if (q.x() < (b[0] - a[0]) * (q.y() - a[1]) / (b[1] - a[1]) + a[0]) inside = !inside;
  }
  return inside;
}

// Whether a raised dot's collar or an occluder hides a place.
bool is_hidden(const host::Scene& scene, const host::Target& target, const Eigen::Vector3d& p) {
  const Eigen::Vector3d eye = -scene.pose.R.transpose() * scene.pose.t;
  for (const host::Dot& dot : target.dots) {
    if (dot.center[2] >= p.z()) continue;
    const Eigen::Vector2d q = seen_through(eye, p, dot.center[2]);
    if (std::hypot(q.x() - dot.center[0], q.y() - dot.center[1]) < dot.collar_radius) return true;
  }
  for (const host::Occluder& occluder : scene.occluders) {
    if (occluder.z_mm >= p.z()) continue;
    if (is_inside(occluder.outline_mm, seen_through(eye, p, occluder.z_mm))) return true;
  }
  return false;
}

// Share of the brightest light that falls on a place of the plate.
double light_at(const host::Light& light, const host::Target& target, const Eigen::Vector2d& q) {
  const double c = std::cos(light.gradient_angle_rad), s = std::sin(light.gradient_angle_rad);
  const double extent =
      0.5 * (target.plate_size_mm[0] * std::abs(c) + target.plate_size_mm[1] * std::abs(s));
  const double rise = std::clamp(0.5 + 0.5 * (q.x() * c + q.y() * s) / extent, 0.0, 1.0);
  double factor = 1 / light.gradient_ratio + (1 - 1 / light.gradient_ratio) * rise;
  if (light.shadow) {
    const host::Shadow& h = *light.shadow;
    const double depth = h.normal_x * q.x() + h.normal_y * q.y() - h.offset_mm;
    if (depth > 0) factor *= h.leaves;
  }
  return factor;
}

// C^2 times the part of an edge's information that lies below the end of the scale:
//   integral of p^2 up to the clip over the whole = Phi(sqrt(2) x), Phi(x) = (255 - b) / C.
double usable_square(double black, double contrast) {
  const double share = (255 - black) / contrast;
  if (share >= 1) return contrast * contrast;
  if (share <= 0) return 0;
  double low = -6, high = 6;
  for (int i = 0; i < 50; ++i) {
    const double x = 0.5 * (low + high);
    (0.5 * std::erfc(-x / std::sqrt(2.0)) < share ? low : high) = x;
  }
  return contrast * contrast * 0.5 * std::erfc(-low);
}

}  // namespace

Eigen::Matrix3d rotation_of(const Eigen::Vector3d& vector) {
  const double angle = vector.norm();
  if (angle < 1e-14) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix();
}

host::Pose moved(const host::Pose& pose, const Vector6& step) {
  host::Pose out = pose;
  out.R = rotation_of(step.head<3>()) * pose.R;
  out.t += step.tail<3>();
  return out;
}

Matrix6 bound_from_renderings(const host::Scene& scene, const host::Camera& camera,
                              const host::Target& target) {
  host::Scene plain = scene;
  plain.background = {host::BackgroundKind::kPlain, scene.light.black_dn, 0};  // no plate border
  const std::vector<float> center = image_of(plain, camera, target);
  const std::vector<Difference> steps = differences(plain);
  const size_t n = steps.size();
  std::vector<std::vector<float>> slopes;
  for (const Difference& d : steps) {
    std::vector<float> slope = image_of(d.high, camera, target);
    const std::vector<float> low = image_of(d.low, camera, target);
    for (size_t i = 0; i < slope.size(); ++i) {
      slope[i] = static_cast<float>((slope[i] - low[i]) / d.step);
      if (center[i] >= 255) slope[i] = 0;
    }
    slopes.push_back(std::move(slope));
  }
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(static_cast<int>(n), static_cast<int>(n));
  for (size_t i = 0; i < n; ++i) {
    for (size_t j = 0; j <= i; ++j) {
      double sum = 0;
      for (size_t k = 0; k < center.size(); ++k) sum += double{slopes[i][k]} * slopes[j][k];
      information(static_cast<int>(i), static_cast<int>(j)) = sum;
      information(static_cast<int>(j), static_cast<int>(i)) = sum;
    }
  }
  const double variance = scene.noise_dn * scene.noise_dn + 1.0 / 12;
  return variance * information.inverse().topLeftCorner<6, 6>();
}

namespace {

Matrix6 bound_of(const std::vector<Outline>& outlines, const host::Scene& scene,
                 const host::Camera& camera, const host::Target& target) {
  const host::Light& light = scene.light;
  const Eigen::Vector3d eye = -scene.pose.R.transpose() * scene.pose.t;
  const double variance = scene.noise_dn * scene.noise_dn + 1.0 / 12;
  const host::Optics& optics = scene.optics;
  const Eigen::Vector2d motion(optics.motion_px * std::cos(optics.motion_angle_rad),
                               optics.motion_px * std::sin(optics.motion_angle_rad));
  Matrix6 information = Matrix6::Zero();
  for (const Outline& outline : outlines) {
    for (int i = 0; i < outline.steps; ++i) {
      const Eigen::Vector3d a = outline.at(static_cast<double>(i) / outline.steps);
      const Eigen::Vector3d b = outline.at((i + 1.0) / outline.steps);
      const Eigen::Vector3d p = outline.at((i + 0.5) / outline.steps);
      if (is_hidden(scene, target, p)) continue;
      const double factor = light_at(light, target, seen_through(eye, p, 0));
      const double contrast = (light.white_dn - light.black_dn) * factor;
      const double black = light.stray_dn + (light.black_dn - light.stray_dn) * factor;
      const host::View view{camera, scene.pose};
      const Eigen::Vector2d along = host::project_point(view, b) - host::project_point(view, a);
      const double length = along.norm();
      const Eigen::Vector2d normal(-along.y() / length, along.x() / length);
      Vector6 j;
      for (int k = 0; k < 6; ++k) {
        Vector6 step = Vector6::Zero();
        step[k] = k < 3 ? 1e-6 : 1e-4;
        const host::Pose low = moved(scene.pose, -step), high = moved(scene.pose, step);
        j[k] = normal.dot(host::project_point({camera, high}, p) -
                          host::project_point({camera, low}, p)) /
               (2 * step[k]);
      }
      const double across = normal.dot(motion);
      const double s2 = optics.defocus_px * optics.defocus_px + (1 + across * across) / 12;
      const double s = std::sqrt(s2);
      const double width = outline.width_mm * length / (b - a).norm();
      const double pulse = 1 - std::exp(-width * width / (4 * s2));
      information += usable_square(black, contrast) / (2 * std::sqrt(kPi) * s * variance) * pulse *
                     length * (j * j.transpose());
    }
  }
  return information.inverse();
}

}  // namespace

Matrix6 bound_from_outlines(const host::Scene& scene, const host::Camera& camera,
                            const host::Target& target) {
  return bound_of(outlines_of(target), scene, camera, target);
}

Matrix6 bound_from_edges(const host::Scene& scene, const host::Camera& camera,
                         const host::Target& plate, const std::vector<PlateEdge>& edges) {
  constexpr int kSteps = 12;
  std::vector<Outline> outlines;
  for (const PlateEdge& edge : edges) {
    outlines.push_back({[edge](double s) {
                          const Eigen::Vector2d p = edge.a + s * (edge.b - edge.a);
                          return Eigen::Vector3d(p.x(), p.y(), 0);
                        },
                        edge.width_mm, kSteps});
  }
  return bound_of(outlines, scene, camera, plate);
}

double rotation_sigma_deg(const Matrix6& covariance) {
  return std::sqrt(covariance.topLeftCorner<3, 3>().trace()) * 180 / kPi;
}

double translation_sigma_mm(const Matrix6& covariance) {
  return std::sqrt(covariance.bottomRightCorner<3, 3>().trace());
}

}  // namespace berth::accuracy
