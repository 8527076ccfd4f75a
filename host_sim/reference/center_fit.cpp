#include "host_sim/reference/center_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace berth::host {
namespace {

using Vector5d = Eigen::Matrix<double, 5, 1>;
using Matrix5d = Eigen::Matrix<double, 5, 5>;

// Neighbouring profiles share pixels and levels: that many points count as one.
constexpr double kCorrelatedPoints = 2.0;
// Interpolation and the outline's linearisation: a centre is never better than this.
constexpr double kFloor_px = 0.003;
constexpr double kTukey = 4.685;

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Standard deviation from the median of absolute values.
double robust_sigma(const std::vector<double>& residuals) {
  std::vector<double> absolute;
  for (const double r : residuals) absolute.push_back(std::abs(r));
  return 1.4826 * median(std::move(absolute));
}

double tukey_weight(double residual, double sigma) {
  const double u = residual / (kTukey * std::max(sigma, 1e-3));
  return std::abs(u) < 1 ? std::pow(1 - u * u, 2) : 0.0;
}

/// Maps the unit circle to the ellipse: p = shape u + center.
struct EllipseFrame {
  Eigen::Matrix2d shape;
  Eigen::Vector2d center;
};

EllipseFrame frame_of(const std::vector<cv::Point2d>& predicted) {
  // In float relative to the first point: OpenCV's fit keeps 1e-4 px, and this is but a start.
  std::vector<cv::Point2f> relative;
  for (const cv::Point2d& p : predicted) relative.emplace_back(p - predicted.front());
  const cv::RotatedRect e = cv::fitEllipse(relative);
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(e.angle * CV_PI / 180).toRotationMatrix();
  return {turn * Eigen::Vector2d(e.size.width / 2, e.size.height / 2).asDiagonal(),
          {predicted.front().x + e.center.x, predicted.front().y + e.center.y}};
}

/// One point's row: distance from the ellipse in px, and its derivative by the five parameters of
/// p = shape (I + [k0 + k1, k2; k2, k0 - k1]) (u + d) + center.
struct Row {
  Vector5d derivative;
  double distance_px;
};

Row row_of(const EllipseFrame& frame, const Eigen::Matrix2d& inverse, const cv::Point2d& p) {
  const Eigen::Vector2d u = inverse * (Eigen::Vector2d(p.x, p.y) - frame.center);
  const double radius = std::max(u.norm(), 1e-9);
  const Eigen::Vector2d n = u / radius;
  const double slope = (inverse.transpose() * n).norm();  // change of radius per px
  Row row;
  row.derivative << n.x(), n.y(), 1, n.x() * n.x() - n.y() * n.y(), 2 * n.x() * n.y();
  row.derivative /= slope;
  row.distance_px = (radius - 1) / slope;
  return row;
}

EllipseFrame updated(const EllipseFrame& frame, const Vector5d& k) {
  Eigen::Matrix2d stretch;
  stretch << 1 + k[2] + k[3], k[4], k[4], 1 + k[2] - k[3];
  return {frame.shape * stretch, frame.center + frame.shape * k.head<2>()};
}

struct Normal {
  Matrix5d matrix = Matrix5d::Zero();
  Vector5d vector = Vector5d::Zero();
  std::vector<double> residuals;
  double weights = 0;
  double squares = 0;
};

Normal normal_equations(const EllipseFrame& frame, const std::vector<cv::Point2d>& points,
                        double sigma) {
  const Eigen::Matrix2d inverse = frame.shape.inverse();
  Normal sum;
  for (const cv::Point2d& p : points) {
    const Row row = row_of(frame, inverse, p);
    const double weight = tukey_weight(row.distance_px, sigma);
    sum.matrix += weight * row.derivative * row.derivative.transpose();
    sum.vector += weight * row.derivative * row.distance_px;
    sum.residuals.push_back(row.distance_px);
    sum.weights += weight;
    sum.squares += weight * row.distance_px * row.distance_px;
  }
  return sum;
}

}  // namespace

std::optional<FittedCenter> fit_ellipse_center(const std::vector<cv::Point2d>& points,
                                               const std::vector<cv::Point2d>& predicted,
                                               std::size_t expected) {
  constexpr int kIterations = 12;
  const double half = static_cast<double>(expected) / 2;
  if (static_cast<double>(points.size()) < std::max(8.0, half)) return std::nullopt;
  EllipseFrame frame = frame_of(predicted);
  double sigma = 3;  // everything counts at first
  Normal sum;
  for (int i = 0; i < kIterations; ++i) {
    sum = normal_equations(frame, points, sigma);
    const Eigen::LDLT<Matrix5d> solver(sum.matrix);
    if (solver.rcond() < 1e-9) return std::nullopt;
    frame = updated(frame, solver.solve(sum.vector));
    if (!frame.shape.allFinite() || frame.shape.determinant() <= 0) return std::nullopt;
    sum = normal_equations(frame, points, sigma);
    sigma = std::max(robust_sigma(sum.residuals), 0.01);
  }
  if (sum.weights < std::max(6.0, 0.8 * half)) return std::nullopt;
  const double variance = std::max(sum.squares / (sum.weights - 5), sigma * sigma * 0.25);
  const Eigen::Matrix2d unit = sum.matrix.inverse().topLeftCorner<2, 2>();
  FittedCenter fitted;
  fitted.center_px = frame.center;
  fitted.covariance_px2 =
      kCorrelatedPoints * variance * frame.shape * unit * frame.shape.transpose() +
      Eigen::Matrix2d::Identity() * kFloor_px * kFloor_px;
  fitted.scatter_px = sigma;
  return fitted;
}

std::optional<FittedCenter> fit_bar_center(const std::vector<BarSide>& sides,
                                           const Eigen::Vector2d& predicted_px) {
  FittedCenter fitted{predicted_px, Eigen::Matrix2d::Identity() * kFloor_px * kFloor_px, 0};
  for (const BarSide& side : sides) {
    if (side.points.size() < 3 || 2 * side.points.size() < side.expected) return std::nullopt;
    const cv::Point2d along = (side.to - side.from) / cv::norm(side.to - side.from);
    const Eigen::Vector2d normal(along.y, -along.x);
    std::vector<double> distances;
    for (const cv::Point2d& p : side.points) {
      distances.push_back(normal.dot(Eigen::Vector2d(p.x - side.from.x, p.y - side.from.y)));
    }
    const double shift = median(distances);
    for (double& d : distances) d -= shift;
    const double sigma = std::max(robust_sigma(distances), 0.01);
    double weights = 0;
    double sum = 0;
    for (const double d : distances) {
      weights += tukey_weight(d, sigma);
      sum += tukey_weight(d, sigma) * d;
    }
    fitted.center_px += normal * (shift + sum / weights) / 2;
    fitted.covariance_px2 +=
        kCorrelatedPoints * sigma * sigma / weights / 4 * normal * normal.transpose();
    fitted.scatter_px = std::max(fitted.scatter_px, sigma);
  }
  return fitted;
}

}  // namespace berth::host
