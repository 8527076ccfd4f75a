#include "host_sim/reference/flatten.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "host_sim/reference/marker_model.hpp"

namespace berth::host {
namespace {

// Levels below this share of the largest contrast would only magnify noise.
constexpr double kLeastContrast = 0.15;

struct Places {
  std::vector<cv::Point3d> white, black;
};

void append(std::vector<cv::Point3d>& to, const std::vector<cv::Point3d>& more) {
  to.insert(to.end(), more.begin(), more.end());
}

Places places_of(const Target& target) {
  Places places;
  const Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  const double width = target.ring.outer - target.ring.inner;
  append(places.white, circle_outline(origin, target.ring.inner + width / 2, 96));
  append(places.black, circle_outline(origin, target.ring.outer + width, 96));
  append(places.black, circle_outline(origin, target.ring.inner - width, 48));
  for (const Dot& dot : target.dots) {
    const Eigen::Vector3d center(dot.center[0], dot.center[1], dot.center[2]);
    append(places.white, circle_outline(center, 0.2 * dot.radius, 12));
    if (dot.center[2] == 0) append(places.black, circle_outline(center, 1.7 * dot.radius, 24));
  }
  Line spine = target.line;
  spine.length *= 0.85;
  spine.width = 0;
  append(places.white, bar_outline(spine, 24));
  spine.width = 3 * target.line.width;
  append(places.black, bar_outline(spine, 24));
  return places;
}

/// a + b u + c v by least squares with Tukey's weights.
struct Plane {
  Eigen::Vector3d coefficients = Eigen::Vector3d::Zero();
  double at(double u, double v) const { return coefficients.dot(Eigen::Vector3d(1, u, v)); }
};

struct Sample {
  double u, v, level;
};

Plane fit_plane(const std::vector<Sample>& samples) {
  constexpr int kIterations = 10;
  Plane plane;
  double sigma = 1e9;
  for (int i = 0; i < kIterations; ++i) {
    Eigen::Matrix3d A = Eigen::Matrix3d::Identity() * 1e-9;
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    std::vector<double> distances;
    for (const Sample& s : samples) {
      const double r = std::abs(s.level - plane.at(s.u, s.v));
      distances.push_back(r);
      const double weight =
          r < 4.685 * sigma ? std::pow(1 - std::pow(r / (4.685 * sigma), 2), 2) : 0;
      const Eigen::Vector3d x(1, s.u, s.v);
      A += weight * x * x.transpose();
      b += weight * s.level * x;
    }
    plane.coefficients = A.ldlt().solve(b);
    distances.clear();
    for (const Sample& s : samples) distances.push_back(std::abs(s.level - plane.at(s.u, s.v)));
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    sigma = std::max(1.4826 * *middle, 0.5);
  }
  return plane;
}

}  // namespace

cv::Mat1f flatten_light(const cv::Mat1f& gray, const Camera& camera, const Target& target,
                        const Rigid& predicted) {
  cv::Mat1f smooth;
  cv::GaussianBlur(gray, smooth, cv::Size(), 1.0);
  const Places places = places_of(target);
  // Coordinates relative to the target's place and size keep the planes well conditioned.
  const Eigen::Vector2d center = project_ideal(camera, predicted, Eigen::Vector3d::Zero());
  const double size_px = target.plate_size_mm[0] / 2 * camera.fx / predicted.t.z();
  const auto sample = [&](const std::vector<cv::Point3d>& points) {
    std::vector<Sample> samples;
    for (const cv::Point2d& p : project_points(camera, predicted, points)) {
      const cv::Point at(static_cast<int>(std::lround(p.x)), static_cast<int>(std::lround(p.y)));
      if (!at.inside(cv::Rect(0, 0, gray.cols, gray.rows))) continue;
      samples.push_back({(p.x - center.x()) / size_px, (p.y - center.y()) / size_px, smooth(at)});
    }
    return samples;
  };
  const Plane white = fit_plane(sample(places.white));
  const Plane black = fit_plane(sample(places.black));
  const Eigen::Vector3d difference = white.coefficients - black.coefficients;
  const double largest = difference[0] + std::hypot(difference[1], difference[2]);
  const double least = std::max(1.0, kLeastContrast * largest);
  cv::Mat1f flat(gray.size());
  for (int y = 0; y < gray.rows; ++y) {
    for (int x = 0; x < gray.cols; ++x) {
      const double u = (x - center.x()) / size_px;
      const double v = (y - center.y()) / size_px;
      const double dark = black.at(u, v);
      const double contrast = std::max(white.at(u, v) - dark, least);
      flat(y, x) = static_cast<float>(100 * (double{gray(y, x)} - dark) / contrast);
    }
  }
  return flat;
}

}  // namespace berth::host
