#include "bench/circles/found_circle.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "host_sim/render/outline.hpp"

namespace berth::bench {
namespace {

constexpr double kShare = 0.05, kLeast_px = 2;

FoundCircle image_of(const host::View& view, const Eigen::Vector3d& center_mm, double radius_mm) {
  std::vector<cv::Point2f> points;
  for (const auto& p : project_circle(view, center_mm, radius_mm)) {
    points.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
  }
  const cv::RotatedRect box = cv::fitEllipseDirect(points);
  const auto [minor, major] = std::minmax(box.size.width, box.size.height);
  return {{box.center.x, box.center.y}, 0.5 * major, 0.5 * minor, false};
}

bool is_outline(const FoundCircle& found, const FoundCircle& truth) {
  const double tolerance = std::max(kShare * truth.major, kLeast_px);
  if (cv::norm(found.center - truth.center) > tolerance) return false;
  if (found.is_circle) {
    return found.major > truth.minor - tolerance && found.major < truth.major + tolerance;
  }
  return std::abs(found.major - truth.major) <= tolerance &&
         std::abs(found.minor - truth.minor) <= std::max(kShare * truth.minor, kLeast_px);
}

}  // namespace

TrueCircles true_circles(const host::Scene& scene, const host::Camera& camera,
                         const host::Target& target) {
  const host::View view{camera, scene.pose};
  TrueCircles truth;
  for (const double radius : {target.ring.outer, target.ring.inner}) {
    truth.ring.push_back(image_of(view, Eigen::Vector3d::Zero(), radius));
  }
  for (const host::Dot& dot : target.dots) {
    truth.dots.push_back(image_of(view, {dot.center[0], dot.center[1], dot.center[2]}, dot.radius));
  }
  return truth;
}

bool is_one_of(const FoundCircle& found, const std::vector<FoundCircle>& outlines) {
  return std::any_of(outlines.begin(), outlines.end(),
                     [&](const FoundCircle& truth) { return is_outline(found, truth); });
}

}  // namespace berth::bench
