#include "host_sim/report/overlay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "host_sim/report/canvas.hpp"
#include "host_sim/report/evaluate.hpp"

namespace berth::host {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kMagnifierSide_px = 340;

/// Projects points of the target by a pose, for drawing.
class Projector {
 public:
  Projector(const Camera& camera, const DoublePose& pose) : camera_(camera), pose_(pose) {}

  cv::Point2d operator()(double x, double y, double z) const {
    const Eigen::Vector3d p = pose_.rotation * Eigen::Vector3d(x, y, z) + pose_.translation_mm;
    if (p.z() < 1) return {-1e6, -1e6};
    const Eigen::Vector2d pixel = project(camera_, p);
    return {pixel.x(), pixel.y()};
  }

  Polyline circle(double x, double y, double z, double radius) const {
    Polyline out;
    for (int i = 0; i < 64; ++i) {
      const double angle = 2 * kPi * i / 64;
      out.push_back((*this)(x + radius * std::cos(angle), y + radius * std::sin(angle), z));
    }
    return out;
  }

  Polyline bar(const Line& line) const {
    const double c = std::cos(line.angle_deg / kDegreesPerRadian);
    const double s = std::sin(line.angle_deg / kDegreesPerRadian);
    Polyline out;
    for (const auto& [along, across] : {std::pair(1, 1), {-1, 1}, {-1, -1}, {1, -1}}) {
      const double u = 0.5 * along * line.length;
      const double v = 0.5 * across * line.width;
      out.push_back((*this)(line.center[0] + c * u - s * v, line.center[1] + s * u + c * v, 0));
    }
    return out;
  }

 private:
  const Camera& camera_;
  const DoublePose& pose_;
};

cv::Point2d center_of(const Marker& marker) {
  return {to_double(marker.center_px[0]), to_double(marker.center_px[1])};
}

/// Where the target is, as far as the packets know: a circle around it.
struct Place {
  cv::Point2d center;
  double radius_px = 0;
};

std::optional<Place> place_of(const FrameRecord& record, const OverlayScene& scene) {
  if (!record.identified()) return std::nullopt;
  const AlgorithmPacket& a = record.algorithm;
  const double plate = std::hypot(scene.target.plate_size_mm[0], scene.target.plate_size_mm[1]) / 2;
  return Place{{to_double(a.ring_center_px[0]), to_double(a.ring_center_px[1])},
               to_double(a.ring_radius_px) * plate / scene.target.ring.outer};
}

void draw_trace(Canvas& canvas, const Trace& trace) {
  static const std::array kChainColors = {cv::Scalar(255, 190, 90),  cv::Scalar(110, 200, 255),
                                          cv::Scalar(150, 255, 150), cv::Scalar(235, 150, 235),
                                          cv::Scalar(120, 255, 240), cv::Scalar(170, 170, 255)};
  for (std::size_t i = 0; i < trace.chains.size(); ++i) {
    canvas.polyline(trace.chains[i], false, kChainColors[i % kChainColors.size()]);
  }
  for (const Polyline& ellipse : trace.ellipses) {
    canvas.polyline(ellipse, true, colors::kYellow);
  }
}

void draw_ring(Canvas& canvas, const FrameRecord& record) {
  const AlgorithmPacket& a = record.algorithm;
  const cv::Point2d center(to_double(a.ring_center_px[0]), to_double(a.ring_center_px[1]));
  const double radius = to_double(a.ring_radius_px);
  const double roll = to_double(a.roll);
  const cv::Point2d x_axis(std::cos(roll), std::sin(roll));
  canvas.cross(center, 4, colors::kMagenta);
  canvas.line(center + x_axis * (0.85 * radius), center + x_axis * (1.15 * radius),
              colors::kMagenta);
  if (record.has_pose()) return;
  // Without a pose its ellipse is not known; the circle on its long axis tells the place.
  Polyline circle;
  for (int i = 0; i < 64; ++i) {
    circle.push_back(center + cv::Point2d(radius * std::cos(2 * kPi * i / 64),
                                          radius * std::sin(2 * kPi * i / 64)));
  }
  canvas.polyline(circle, true, colors::kMagenta);
}

void draw_pose(Canvas& canvas, const DoublePose& pose, const OverlayScene& scene) {
  const Projector project_target(scene.camera, pose);
  const Target& target = scene.target;
  canvas.polyline(project_target.circle(0, 0, 0, target.ring.outer), true, colors::kMagenta);
  canvas.polyline(project_target.circle(0, 0, 0, target.ring.inner), true, colors::kMagenta);
  canvas.polyline(project_target.bar(target.line), true, colors::kCyan);
  for (const Dot& dot : target.dots) {
    canvas.polyline(project_target.circle(dot.center[0], dot.center[1], dot.center[2], dot.radius),
                    true, colors::kCyan);
  }
  const double arm = 0.9 * target.ring.outer;
  const cv::Point2d origin = project_target(0, 0, 0);
  canvas.arrow(origin, project_target(arm, 0, 0), colors::kRed);
  canvas.arrow(origin, project_target(0, arm, 0), colors::kGreen);
  canvas.arrow(origin, project_target(0, 0, arm), colors::kBlue);
}

void draw_markers(Canvas& canvas, const FrameRecord& record) {
  const AlgorithmPacket& a = record.algorithm;
  const cv::Point2d middle(to_double(a.ring_center_px[0]), to_double(a.ring_center_px[1]));
  const double ring = to_double(a.ring_radius_px);
  const MarkerSet& set = record.markers.set;
  for (int i = 0; i < set.count; ++i) {
    const Marker& marker = set.markers[i];
    if (!marker.located) continue;
    const cv::Scalar& color = marker.used ? colors::kGreen : colors::kRed;
    const cv::Point2d center = center_of(marker);
    canvas.cross(center, 5, color);
    // Outwards, but inside the ring, where the axes start, to the left.
    const cv::Point2d out = center - middle;
    const double length = std::hypot(out.x, out.y);
    const double gap =
        14 + 0.22 * ring * canvas.scale();  // a dot's radius is a fifth of the ring's
    canvas.label(marker_name(marker), center,
                 length < 0.9 * ring ? cv::Point2d(-gap, 0) : out * (gap / length), color);
  }
}

void draw_findings(Canvas& canvas, const FrameRecord& record, const Trace* trace,
                   const OverlayScene& scene) {
  if (trace) draw_trace(canvas, *trace);
  if (!record.identified()) return;
  draw_ring(canvas, record);
  if (record.has_pose()) {
    draw_pose(canvas, to_double(record.pose.camera_from_target), scene);
  }
  draw_markers(canvas, record);
}

std::vector<std::string> pose_text(const FrameRecord& record) {
  const PosePacket& p = record.pose;
  const DoublePose pose = to_double(p.camera_from_target);
  const auto covariance = to_double(p.covariance);
  const double sigma_r = std::sqrt(covariance.topLeftCorner<3, 3>().trace()) * kDegreesPerRadian;
  const double sigma_t = std::sqrt(covariance.bottomRightCorner<3, 3>().trace());
  const Eigen::Vector3d& t = pose.translation_mm;
  const Eigen::Quaterniond& q = pose.rotation;
  return {
      fmt::format("t {:.3f} {:.3f} {:.3f} mm", t.x(), t.y(), t.z()),
      fmt::format("q {:.6f} {:.6f} {:.6f} {:.6f}", q.w(), q.x(), q.y(), q.z()),
      fmt::format("distance {:.2f} mm, tilt {:.2f} deg", t.norm(), tilt_deg(pose)),
      fmt::format("sigma {:.5f} deg, {:.4f} mm", sigma_r, sigma_t),
      fmt::format("residual {:.3f} px, {} markers", to_double(p.residual_px), int{p.markers_used})};
}

std::vector<std::string> text_of(const FrameRecord& record) {
  std::vector<std::string> lines = {record.file};
  const bool valid = record.valid();
  lines.push_back(valid ? "valid" : fmt::format("not valid: {}", reason_name(record.reason())));
  if (record.has_pose()) {
    const auto pose = pose_text(record);
    lines.insert(lines.end(), pose.begin(), pose.end());
  }
  const FrameTally& n = record.algorithm.tally;
  if (record.identified() && n.identified_rank == 0) {
    lines.push_back("tracked from the last pose, without edges");
  } else {
    lines.push_back(fmt::format("{} edge pixels, {} chains", n.edge_pixels, n.chains));
    lines.push_back(fmt::format("{} circles, {} ellipses, ", n.circle_candidates, n.ellipses) +
                    (n.identified_rank == 0
                         ? "none is the target"
                         : fmt::format("no. {} is the target", n.identified_rank)));
  }
  if (n.targets > 1) lines.push_back(fmt::format("{} targets in view", n.targets));
  lines.push_back(fmt::format("noise {:.1f} DN, black {}, white {}", n.noise_q8 / 256.0,
                              int{n.black}, int{n.white}));
  return lines;
}

/// The corner of the picture where a box of this size is farthest from the target.
cv::Point free_corner(cv::Size picture, cv::Size box, const std::optional<Place>& place,
                      const cv::Rect& taken) {
  constexpr int kGap = 8;
  const int right = std::max(kGap, picture.width - box.width - kGap);
  const int bottom = std::max(kGap, picture.height - box.height - kGap);
  cv::Point best(kGap, kGap);
  double best_distance = -1;
  for (const cv::Point corner : {cv::Point(kGap, kGap), cv::Point(right, kGap),
                                 cv::Point(kGap, bottom), cv::Point(right, bottom)}) {
    const cv::Rect rect(corner, box);
    if ((rect & taken).area() > 0) continue;
    const cv::Point2d middle(corner.x + box.width / 2.0, corner.y + box.height / 2.0);
    const cv::Point2d d = place ? middle - place->center : cv::Point2d(1, 0);
    const double distance = std::hypot(d.x, d.y);
    if (distance > best_distance) {
      best_distance = distance;
      best = corner;
    }
  }
  return best;
}

cv::Rect draw_magnifier(cv::Mat& picture, const cv::Mat& image, const FrameRecord& record,
                        const Trace* trace, const OverlayScene& scene, const Place& place) {
  const double scale = kMagnifierSide_px / (2.3 * place.radius_px);
  if (scale < 1.5 || std::min(picture.cols, picture.rows) < 2 * kMagnifierSide_px) return {};
  Canvas window(image, place.center, scale, kMagnifierSide_px);
  draw_findings(window, record, trace, scene);
  const cv::Size side(kMagnifierSide_px, kMagnifierSide_px);
  const cv::Rect rect(free_corner(picture.size(), side, place, {}), side);
  window.picture().copyTo(picture(rect));
  cv::rectangle(picture, rect, colors::kGrey);
  draw_text_box(picture, {rect.x + 4, rect.y + rect.height - 36}, {fmt::format("x {:.1f}", scale)});
  return rect;
}

}  // namespace

cv::Mat draw_overlay(const cv::Mat& image, const FrameRecord& record, const Trace* trace,
                     const OverlayScene& scene) {
  const cv::Mat shown =
      image.empty() ? cv::Mat(scene.camera.height, scene.camera.width, CV_8UC1, cv::Scalar(64))
                    : image;
  Canvas canvas(shown);
  draw_findings(canvas, record, trace, scene);
  const std::optional<Place> place = place_of(record, scene);
  cv::Rect taken;
  if (place) taken = draw_magnifier(canvas.picture(), shown, record, trace, scene, *place);
  const std::vector<std::string> text = text_of(record);
  const cv::Size box = text_box_size(text);
  draw_text_box(canvas.picture(), free_corner(shown.size(), box, place, taken), text);
  return canvas.picture();
}

}  // namespace berth::host
