#include "host_sim/reference/identify.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "host_sim/reference/circle_pose.hpp"
#include "host_sim/reference/double_twin.hpp"
#include "host_sim/reference/layout_check.hpp"
#include "host_sim/reference/marker_model.hpp"

namespace berth::host {
namespace {

constexpr double kMinRingSemiAxis_px = 8;
constexpr double kBlobSigma_px = 0.3;
constexpr std::size_t kHypothesesPerRing = 12;

struct Seen {  // a blob with its centre in the ideal image
  Blob blob;
  Eigen::Vector2d ideal_px;
};

struct Hypothesis {
  Rigid pose;
  std::vector<const Seen*> matches;  // per dot of the target, null where there is none
  int matched = 0;
};

Eigen::Vector3d center_of(const Dot& dot) { return {dot.center[0], dot.center[1], dot.center[2]}; }

class Identifier {
 public:
  Identifier(const cv::Mat& gray, const Camera& camera, const Target& target,
             const std::vector<Blob>& blobs)
      : camera_(camera), target_(target) {
    cv::GaussianBlur(gray, smooth_, cv::Size(), 1.2);
    std::vector<cv::Point2d> centers;
    for (const Blob& blob : blobs) centers.push_back(blob.center());
    const auto ideal = ideal_points(camera, centers);
    for (std::size_t i = 0; i < blobs.size(); ++i) {
      seen_.push_back({blobs[i], {ideal[i].x, ideal[i].y}});
    }
  }

  std::optional<Rigid> best() const {
    std::optional<Rigid> best_pose;
    double best_total = 0;
    for (const Seen& ring : seen_) {
      if (ring.blob.semi_minor_px() < kMinRingSemiAxis_px) continue;
      for (const Hypothesis& h : hypotheses(ring)) {
        const std::optional<Rigid> pose = refined(h, ring);
        if (!pose) continue;
        const LayoutScore score = score_layout(smooth_, camera_, target_, *pose);
        if (!score.is_target() || score.total() <= best_total) continue;
        best_total = score.total();
        best_pose = pose;
      }
    }
    return best_pose;
  }

 private:
  Eigen::Vector3d ray(const Seen& seen) const {
    return {(seen.ideal_px.x() - camera_.cx) / camera_.fx,
            (seen.ideal_px.y() - camera_.cy) / camera_.fy, 1};
  }

  bool has_size(const Seen& seen, double radius_mm, double depth_mm, double factor) const {
    const double predicted_px = radius_mm * std::sqrt(camera_.fx * camera_.fy) / depth_mm;
    const double ratio = (seen.blob.semi_major_px() + 0.5) / (predicted_px + 0.5);
    return ratio > 1 / factor && ratio < factor;
  }

  /// Rolls at which some blob is some flat dot of the target.
  void add_rolls(const CirclePose& circle, double ring_px, std::vector<Hypothesis>& list) const {
    Eigen::Matrix3d axes;  // an arbitrary roll
    axes.col(2) = circle.normal;
    axes.col(0) = Eigen::Vector3d::UnitY().cross(circle.normal).normalized();
    axes.col(1) = axes.col(2).cross(axes.col(0));
    for (const Seen& seen : seen_) {
      const Eigen::Vector3d r = ray(seen);
      const double depth = circle.normal.dot(circle.center_mm) / circle.normal.dot(r);
      if (!(depth > 0)) continue;
      const Eigen::Vector3d place = axes.transpose() * (depth * r - circle.center_mm);
      for (const Dot& dot : target_.dots) {
        const double radius = std::hypot(dot.center[0], dot.center[1]);
        if (dot.center[2] != 0 || radius < target_.ring.outer / 4) continue;
        if (std::abs(std::hypot(place.x(), place.y()) - radius) > 0.2 * radius) continue;
        if (!has_size(seen, dot.radius, depth, 2)) continue;
        const double roll =
            std::atan2(place.y(), place.x()) - std::atan2(dot.center[1], dot.center[0]);
        list.push_back(matched({axes * rotation_exp({0, 0, roll}), circle.center_mm}, ring_px));
      }
    }
  }

  Hypothesis matched(const Rigid& pose, double ring_px) const {
    Hypothesis h;
    h.pose = pose;
    for (const Dot& dot : target_.dots) {
      const Eigen::Vector2d place = project_ideal(camera_, pose, center_of(dot));
      const double depth = (pose.R * center_of(dot) + pose.t).z();
      const Seen* nearest = nullptr;
      double nearest_px = 0.15 * ring_px + 1.5;
      for (const Seen& seen : seen_) {
        const double distance = (seen.ideal_px - place).norm();
        if (distance >= nearest_px || !has_size(seen, dot.radius, depth, 1.8)) continue;
        nearest = &seen;
        nearest_px = distance;
      }
      h.matches.push_back(nearest);
      h.matched += nearest != nullptr;
    }
    return h;
  }

  std::vector<Hypothesis> hypotheses(const Seen& ring) const {
    std::vector<Hypothesis> list;
    for (const CirclePose& circle : circle_poses(camera_, ring.blob.ellipse, target_.ring.outer)) {
      add_rolls(circle, ring.blob.semi_major_px(), list);
    }
    std::stable_sort(list.begin(), list.end(), [](const Hypothesis& a, const Hypothesis& b) {
      return a.matched > b.matched;
    });
    const auto is_weak = [](const Hypothesis& h) { return h.matched < 3; };
    list.erase(std::find_if(list.begin(), list.end(), is_weak), list.end());
    if (list.size() > kHypothesesPerRing) list.resize(kHypothesesPerRing);
    return list;
  }

  std::optional<Rigid> refined(const Hypothesis& h, const Seen& ring) const {
    std::vector<Observation> observations;
    const auto add = [&](const Seen& seen, const Circle& circle) {
      const auto predict = [this, circle](const Rigid& pose) {
        return conic_center(camera_, pose, circle);
      };
      observations.push_back(
          {seen.ideal_px, Eigen::Matrix2d::Identity() * std::pow(kBlobSigma_px, 2), predict});
    };
    add(ring, {Eigen::Vector3d::Zero(), target_.ring.outer});
    for (std::size_t i = 0; i < target_.dots.size(); ++i) {
      const Dot& dot = target_.dots[i];
      if (h.matches[i]) add(*h.matches[i], {center_of(dot), dot.radius});
    }
    const RefinedPose refined = refine_pose(observations, h.pose);
    const double limit_px = 0.05 * ring.blob.semi_major_px() + 1;
    if (!refined.has_converged || refined.rms_px > limit_px) return std::nullopt;
    return refined.camera_from_target;
  }

  const Camera& camera_;
  const Target& target_;
  cv::Mat smooth_;
  std::vector<Seen> seen_;
};

}  // namespace

std::optional<Rigid> identify_target(const cv::Mat& gray, const Camera& camera,
                                     const Target& target, const std::vector<Blob>& blobs) {
  return Identifier(gray, camera, target, blobs).best();
}

}  // namespace berth::host
