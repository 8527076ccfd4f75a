#include "host_sim/reference/measure.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/reference/center_fit.hpp"
#include "host_sim/reference/edge_points.hpp"
#include "host_sim/reference/marker_model.hpp"

namespace berth::host {
namespace {

constexpr double kMaxSearch_px = 5;
// What neighbours, the plate's border and uneven light do to a blurred edge grows with the square
// of the blur; the factor makes the sigmas of rendered frames of the envelope true.
constexpr double kSystematicPerBlur2 = 0.004;

class Measurer {
 public:
  Measurer(const cv::Mat1f& flat, const Camera& camera, const Target& target, const Rigid& pose)
      : flat_(flat), camera_(camera), target_(target), pose_(pose) {
    double narrowest = std::min(target.line.width, target.ring.outer - target.ring.inner);
    for (const Dot& dot : target.dots) narrowest = std::min(narrowest, dot.radius);
    dark_px_ = std::min(kMaxSearch_px, 0.8 * foreshortened_px(narrowest));
  }

  void circle(const std::string& name, const Circle& circle, bool is_bright_inside,
              double bright_mm) {
    const auto pixels = dense_outline(circle);
    EdgeSearch search;
    search.bright_px = std::min(kMaxSearch_px, 0.9 * foreshortened_px(bright_mm));
    search.dark_px = dark_px_;
    search.is_bright_inside = is_bright_inside;
    const LocatedEdge edge = locate_edge(flat_, pixels, search);
    const auto center = fit_ellipse_center(ideal_points(camera_, edge.points),
                                           ideal_points(camera_, pixels), pixels.size());
    if (!center) return;
    add(name, *center, edge.blur_px, [camera = camera_, circle](const Rigid& pose) {
      return conic_center(camera, pose, circle);
    });
  }

  void line() {
    const auto corners_mm = bar_outline(target_.line, 1);
    std::vector<BarSide> sides;
    double line_blur_px = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      sides.push_back(bar_side(corners_mm[i], corners_mm[(i + 1) % 4], i % 2 == 0));
      line_blur_px = std::max(line_blur_px, sides.back().blur_px);
    }
    const Eigen::Vector3d center_mm(target_.line.center[0], target_.line.center[1], 0);
    const auto center = fit_bar_center(sides, project_ideal(camera_, pose_, center_mm));
    if (!center) return;
    add("line", *center, line_blur_px, [camera = camera_, center_mm](const Rigid& pose) {
      return project_ideal(camera, pose, center_mm);
    });
  }

  std::vector<MeasuredMarker> take() { return std::move(markers_); }

 private:
  /// A length on the plate in the direction in which it is seen shortest.
  double foreshortened_px(double length_mm) const {
    const double cosine = std::abs(pose_.R.col(2).dot(pose_.t.normalized()));
    return length_mm * std::min(camera_.fx, camera_.fy) / pose_.t.z() * cosine;
  }

  std::vector<cv::Point2d> dense_outline(const Circle& circle) const {
    const double radius_px = circle.radius_mm * camera_.fx / pose_.t.z();
    const int count = std::clamp(static_cast<int>(2 * CV_PI * radius_px), 16, 2000);
    return project_points(camera_, pose_,
                          circle_outline(circle.center_mm, circle.radius_mm, count));
  }

  BarSide bar_side(const cv::Point3d& from, const cv::Point3d& to, bool is_long) const {
    const double length_px = cv::norm(to - from) * camera_.fx / pose_.t.z();
    const int count = std::max(5, static_cast<int>(is_long ? length_px : 2 * length_px));
    // Corners are round; the middle of a short side and most of a long one is straight.
    const double keep = is_long ? 0.8 : 0.5;
    std::vector<cv::Point3d> places;
    for (int i = 0; i < count; ++i) {
      const double step = 0.5 + keep * ((i + 0.5) / count - 0.5);
      places.push_back(from + step * (to - from));
    }
    EdgeSearch search;
    search.bright_px = is_long
                           ? std::min(kMaxSearch_px, 0.5 * foreshortened_px(target_.line.width))
                           : std::min(kMaxSearch_px, 0.3 * foreshortened_px(target_.line.length));
    search.dark_px = dark_px_;
    search.is_closed = false;
    BarSide side;
    const auto ends = ideal_points(camera_, project_points(camera_, pose_, {from, to}));
    side.from = ends[0];
    side.to = ends[1];
    const LocatedEdge edge = locate_edge(flat_, project_points(camera_, pose_, places), search);
    side.points = ideal_points(camera_, edge.points);
    side.blur_px = edge.blur_px;
    side.expected = static_cast<std::size_t>(count);
    return side;
  }

  void add(const std::string& name, const FittedCenter& center, double blur_px,
           std::function<Eigen::Vector2d(const Rigid&)> predict) {
    const double systematic_px = kSystematicPerBlur2 * blur_px * blur_px;
    const Eigen::Matrix2d covariance =
        center.covariance_px2 + Eigen::Matrix2d::Identity() * systematic_px * systematic_px;
    markers_.push_back({name, {center.center_px, covariance, std::move(predict)}});
  }

  const cv::Mat1f& flat_;
  const Camera& camera_;
  const Target& target_;
  const Rigid& pose_;
  double dark_px_ = 0;
  std::vector<MeasuredMarker> markers_;
};

}  // namespace

std::vector<MeasuredMarker> measure_markers(const cv::Mat1f& flat, const Camera& camera,
                                            const Target& target, const Rigid& predicted) {
  Measurer measurer(flat, camera, target, predicted);
  for (const Dot& dot : target.dots) {
    const Eigen::Vector3d center(dot.center[0], dot.center[1], dot.center[2]);
    measurer.circle(dot.name, {center, dot.radius}, true, dot.radius);
  }
  const double half_width = (target.ring.outer - target.ring.inner) / 2;
  measurer.circle("ring_outer", {Eigen::Vector3d::Zero(), target.ring.outer}, true, half_width);
  measurer.circle("ring_inner", {Eigen::Vector3d::Zero(), target.ring.inner}, false, half_width);
  measurer.line();
  return measurer.take();
}

}  // namespace berth::host
