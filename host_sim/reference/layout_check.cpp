#include "host_sim/reference/layout_check.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "host_sim/reference/marker_model.hpp"

namespace berth::host {
namespace {

constexpr double kMinContrast_dn = 8;
constexpr double kMinShare = 0.6;
constexpr double kMinLineShare = 0.4;  // half of it may be hidden

double level(const cv::Mat& image, const cv::Point2d& p) {
  const int x = static_cast<int>(std::lround(p.x));
  const int y = static_cast<int>(std::lround(p.y));
  const bool is_inside = x >= 0 && y >= 0 && x < image.cols && y < image.rows;
  return is_inside ? 1.0 * image.at<std::uint8_t>(y, x) : std::nan("");
}

/// White places, each with two black ones beside it.
struct Samples {
  std::vector<cv::Point3d> white, black_a, black_b;
};

std::vector<double> contrasts(const cv::Mat& image, const Camera& camera, const Rigid& pose,
                              const Samples& samples) {
  const auto white = project_points(camera, pose, samples.white);
  const auto black_a = project_points(camera, pose, samples.black_a);
  const auto black_b = project_points(camera, pose, samples.black_b);
  std::vector<double> result;
  for (std::size_t i = 0; i < white.size(); ++i) {
    const double c =
        level(image, white[i]) - std::max(level(image, black_a[i]), level(image, black_b[i]));
    result.push_back(std::isfinite(c) ? c : 0.0);
  }
  return result;
}

Samples ring_samples(const Ring& ring) {
  constexpr int kCount = 72;
  const double width = ring.outer - ring.inner;
  const Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  return {circle_outline(origin, (ring.outer + ring.inner) / 2, kCount),
          circle_outline(origin, ring.outer + width / 2, kCount),
          circle_outline(origin, ring.inner - width / 2, kCount)};
}

Samples dot_samples(const Dot& dot) {
  constexpr int kCount = 16;
  const Eigen::Vector3d center(dot.center[0], dot.center[1], dot.center[2]);
  const double beside =
      dot.collar_radius > 0 ? (dot.radius + dot.collar_radius) / 2 : 1.5 * dot.radius;
  const auto black = circle_outline(center, beside, kCount);
  return {circle_outline(center, 0.4 * dot.radius, kCount), black, black};
}

Samples line_samples(const Line& line) {
  constexpr int kCount = 25;
  const double angle = line.angle_deg * CV_PI / 180;
  const cv::Point3d along(std::cos(angle), std::sin(angle), 0);
  const cv::Point3d across(-along.y, along.x, 0);
  const cv::Point3d center(line.center[0], line.center[1], 0);
  Samples samples;
  for (int i = 0; i < kCount; ++i) {
    const double u = 0.9 * line.length * ((i + 0.5) / kCount - 0.5);
    samples.white.push_back(center + u * along);
    samples.black_a.push_back(center + u * along + line.width * across);
    samples.black_b.push_back(center + u * along - line.width * across);
  }
  return samples;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

double share_above(const std::vector<double>& values, double limit) {
  const auto count =
      std::count_if(values.begin(), values.end(), [&](double v) { return v > limit; });
  return static_cast<double>(count) / static_cast<double>(values.size());
}

}  // namespace

bool LayoutScore::is_target() const {
  const auto present = static_cast<std::size_t>(
      std::count_if(dots.begin(), dots.end(), [](double share) { return share >= kMinShare; }));
  return contrast_dn >= kMinContrast_dn && ring >= kMinShare && line >= kMinLineShare &&
         present >= std::max<std::size_t>(3, dots.size() - 1);
}

double LayoutScore::total() const {
  return ring + line + std::accumulate(dots.begin(), dots.end(), 0.0);
}

LayoutScore score_layout(const cv::Mat& smooth, const Camera& camera, const Target& target,
                         const Rigid& pose) {
  const std::vector<double> ring = contrasts(smooth, camera, pose, ring_samples(target.ring));
  LayoutScore score;
  score.contrast_dn = median(ring);
  // Light may fall to a quarter across the plate and to less than a third in a shadow.
  const double limit = std::max(4.0, 0.12 * score.contrast_dn);
  score.ring = share_above(ring, limit);
  score.line = share_above(contrasts(smooth, camera, pose, line_samples(target.line)), limit);
  for (const Dot& dot : target.dots) {
    score.dots.push_back(share_above(contrasts(smooth, camera, pose, dot_samples(dot)), limit));
  }
  return score;
}

}  // namespace berth::host
