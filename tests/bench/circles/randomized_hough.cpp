#include "bench/circles/randomized_hough.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <unordered_map>

namespace berth::bench {
namespace {

std::optional<cv::Vec3d> circle_through(cv::Point2d a, cv::Point2d b, cv::Point2d c) {
  const cv::Point2d p = b - a, q = c - a;
  const double d = 2 * p.cross(q);
  if (std::abs(d) < 1) return std::nullopt;
  const double pp = p.dot(p), qq = q.dot(q);
  const cv::Point2d u((q.y * pp - p.y * qq) / d, (p.x * qq - q.x * pp) / d);
  return cv::Vec3d(a.x + u.x, a.y + u.y, cv::norm(u));
}

// Share of 128 places along the circle with an edge point within a pixel.
double support(const cv::Mat& near_edge, const cv::Vec3d& circle) {
  constexpr int kPlaces = 128;
  int hits = 0;
  for (int k = 0; k < kPlaces; ++k) {
    const double t = 2 * CV_PI * k / kPlaces;
    const cv::Point p(cvRound(circle[0] + circle[2] * std::cos(t)),
                      cvRound(circle[1] + circle[2] * std::sin(t)));
    hits += cv::Rect({}, near_edge.size()).contains(p) && near_edge.at<uchar>(p) != 0;
  }
  return static_cast<double>(hits) / kPlaces;
}

cv::Mat dilated(const cv::Mat& edges) {
  cv::Mat out;
  cv::dilate(edges, out, cv::getStructuringElement(cv::MORPH_RECT, {3, 3}));
  return out;
}

}  // namespace

std::vector<cv::Vec3d> randomized_hough(const cv::Mat& edges, const RandomizedHoughOptions& options,
                                        std::uint64_t seed) {
  cv::Mat left = edges.clone(), near_edge = dilated(edges);
  std::vector<cv::Point> points;
  cv::findNonZero(left, points);
  std::vector<cv::Vec3d> circles;
  std::unordered_map<std::int64_t, int> list;
  cv::RNG rng(seed);
  const auto pick = [&] {
    return points[static_cast<size_t>(rng.uniform(0, static_cast<int>(points.size())))];
  };
  for (int trial = 0; trial < options.trials && points.size() >= 30; ++trial) {
    const auto circle = circle_through(pick(), pick(), pick());
    if (!circle) continue;
    const double x = (*circle)[0], y = (*circle)[1], r = (*circle)[2];
    if (r < options.radius_min || r > options.radius_max) continue;
    if (x < 0 || y < 0 || x >= edges.cols || y >= edges.rows) continue;
    const auto cell = [&](double v) { return static_cast<std::int64_t>(v / options.cell_px); };
    const std::int64_t key = (cell(x) * 4096 + cell(y)) * 4096 + cell(r);
    if (++list[key] != options.hits || support(near_edge, *circle) < options.support) continue;
    circles.push_back(*circle);
    cv::circle(left, {cvRound(x), cvRound(y)}, cvRound(r), cv::Scalar(0), 3);
    near_edge = dilated(left);
    cv::findNonZero(left, points);
    list.clear();
  }
  return circles;
}

}  // namespace berth::bench
