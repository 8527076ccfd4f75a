// Centres of markers from their edge points in the ideal image, with honest covariances.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

namespace berth::host {

struct FittedCenter {
  Eigen::Vector2d center_px;
  Eigen::Matrix2d covariance_px2;  ///< from the scatter of the edge points about the fit
  double scatter_px = 0;           ///< robust standard deviation of an edge point
};

/// Centre of the ellipse through the points: geometric least squares with Tukey's weights, from the
/// ellipse of the predicted outline. Nothing where less than half of `expected` points fit or the
/// arc is too short to hold the centre.
std::optional<FittedCenter> fit_ellipse_center(const std::vector<cv::Point2d>& points,
                                               const std::vector<cv::Point2d>& predicted,
                                               std::size_t expected);

/// A side of the bar: its predicted ends in the ideal image, from x towards y around the bar, and
/// the edge points found along it.
struct BarSide {
  cv::Point2d from, to;
  std::vector<cv::Point2d> points;
  std::size_t expected = 0;
  double blur_px = 0;
};

/// Centre of a bar near `predicted`: opposite sides moved by d1 and d2 along their outward normals
/// move it by half of d1 n1 + d2 n2. Nothing where a side has less than half of its points.
std::optional<FittedCenter> fit_bar_center(const std::vector<BarSide>& sides,
                                           const Eigen::Vector2d& predicted_px);

}  // namespace berth::host
