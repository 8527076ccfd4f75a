// Centroids of noise-free rendered markers against the area centroid of the outline as OpenCV
// projects it, to 0.0005 px: the yardstick of estimators that reach a few thousandths.
#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "host_sim/render/render.hpp"
#include "host_sim/render/sample_pose.hpp"
#include "host_sim/render/sample_scene.hpp"
#include "tests/render/outline_reference.hpp"

namespace berth::host {
namespace {

constexpr double kTolerance_px = 0.0005;
constexpr double kAreaTolerance = 2e-4;

struct MarkerOutline {
  std::string name;
  std::vector<cv::Point2d> outer;
  std::vector<cv::Point2d> hole;
};

std::vector<MarkerOutline> reference_outlines(const Camera& camera, const Pose& pose,
                                              const Target& target) {
  const auto project_all = [&](const std::vector<cv::Point3d>& points) {
    return project_by_opencv(camera, pose, points);
  };
  std::vector<MarkerOutline> outlines;
  outlines.push_back({"ring", project_all(circle_points(0, 0, 0, target.ring.outer)),
                      project_all(circle_points(0, 0, 0, target.ring.inner))});
  const Line& line = target.line;
  outlines.push_back({"line",
                      project_all(rectangle_points(line.center[0], line.center[1], line.length,
                                                   line.width, line.angle_deg * CV_PI / 180.0)),
                      {}});
  for (const Dot& dot : target.dots) {
    const auto circle = circle_points(dot.center[0], dot.center[1], dot.center[2], dot.radius);
    outlines.push_back({dot.name, project_all(circle), {}});
  }
  return outlines;
}

AreaMoments expected_moments(const MarkerOutline& outline) {
  const AreaMoments whole = polygon_moments(outline.outer);
  return outline.hole.empty() ? whole : without_hole(whole, polygon_moments(outline.hole));
}

// Pixels whose centres are at most `reach_px` outside the marker.
cv::Mat1b mask_around(const MarkerOutline& outline, const Camera& camera, double reach_px) {
  const auto fill = [&](const std::vector<cv::Point2d>& polygon) {
    std::vector<cv::Point> rounded;
    for (const cv::Point2d& p : polygon) rounded.emplace_back(cvRound(p.x), cvRound(p.y));
    cv::Mat1b mask(camera.height, camera.width, uchar(0));
    cv::fillPoly(mask, std::vector<std::vector<cv::Point>>{rounded}, cv::Scalar(1));
    return mask;
  };
  const int side = 2 * static_cast<int>(std::ceil(reach_px)) + 1;
  const cv::Mat disc = cv::getStructuringElement(cv::MORPH_ELLIPSE, {side, side});
  cv::Mat1b mask;
  cv::dilate(fill(outline.outer), mask, disc);
  if (!outline.hole.empty()) {
    cv::Mat1b inner;
    cv::erode(fill(outline.hole), inner, disc);
    mask.setTo(0, inner);
  }
  return mask;
}

AreaMoments measured_moments(const std::vector<float>& image, const cv::Mat1b& mask,
                             double ground_dn, double marker_dn) {
  double sum = 0, sx = 0, sy = 0;
  for (int y = 0; y < mask.rows; ++y) {
    for (int x = 0; x < mask.cols; ++x) {
      if (!mask(y, x)) continue;
      const double value =
          image[static_cast<size_t>(y) * static_cast<size_t>(mask.cols) + x] - ground_dn;
      sum += value;
      sx += value * x;
      sy += value * y;
    }
  }
  return {sum / (marker_dn - ground_dn), sx / sum, sy / sum};
}

// On a background as black as the plate only the markers are left above black.
Scene bare_scene(const Viewpoint& viewpoint, const Camera& camera) {
  Scene scene = clean_scene(pose_from_viewpoint(viewpoint, camera));
  scene.background.level_dn = scene.light.black_dn;
  return scene;
}

void expect_centroids(const Scene& scene, const Camera& camera, const Target& target,
                      double reach_px) {
  std::vector<float> image;
  render(scene, camera, target, image);
  const double ground_dn = target.white_on_black ? scene.light.black_dn : scene.light.white_dn;
  const double marker_dn = target.white_on_black ? scene.light.white_dn : scene.light.black_dn;
  for (const MarkerOutline& outline : reference_outlines(camera, scene.pose, target)) {
    const AreaMoments expected = expected_moments(outline);
    const AreaMoments measured =
        measured_moments(image, mask_around(outline, camera, reach_px), ground_dn, marker_dn);
    EXPECT_NEAR(measured.x, expected.x, kTolerance_px) << outline.name;
    EXPECT_NEAR(measured.y, expected.y, kTolerance_px) << outline.name;
    EXPECT_NEAR(measured.area, expected.area, kAreaTolerance * expected.area) << outline.name;
  }
}

Camera without_distortion() {
  Camera camera = default_camera();
  camera.k1 = camera.k2 = camera.p1 = camera.p2 = camera.k3 = 0.0;
  return camera;
}

struct Case {
  Viewpoint viewpoint;
  double reach_px;
};

// Tilts at which the collar, and farther away the blur of D0, leave the ring alone.
const Case kCases[] = {
    {{300, 0, 0, 0, {511.5, 511.5}}, 8},       {{300, 30, 70, 25, {480.3, 530.7}}, 8},
    {{420, 20, 200, -130, {360.2, 655.9}}, 8}, {{700, 25, 310, 100, {890.4, 130.3}}, 6},
    {{1000, 10, 140, -60, {130.6, 140.1}}, 5}, {{1500, 12, 20, 45, {900.8, 940.2}}, 4},
};

TEST(Centroid, MatchesProjectionWithDistortion) {
  const Camera camera = default_camera();
  for (const Case& c : kCases) {
    SCOPED_TRACE(c.viewpoint.distance_mm);
    expect_centroids(bare_scene(c.viewpoint, camera), camera, default_target(), c.reach_px);
  }
}

TEST(Centroid, MatchesProjectionWithoutDistortion) {
  const Camera camera = without_distortion();
  for (const Case& c : kCases) {
    SCOPED_TRACE(c.viewpoint.distance_mm);
    expect_centroids(bare_scene(c.viewpoint, camera), camera, default_target(), c.reach_px);
  }
}

void expect_centroids_under(PsfKind kind, double motion_angle_rad) {
  const Camera camera = default_camera();
  Scene scene = bare_scene({300, 12, 70, 25, {480.3, 530.7}}, camera);
  scene.optics.psf = kind;
  scene.optics.defocus_px = 1.5;
  scene.optics.motion_px = 6.0;
  scene.optics.motion_angle_rad = motion_angle_rad;
  expect_centroids(scene, camera, default_target(), 13);
}

TEST(Centroid, StaysUnderDefocusAndMotion) {
  for (const double angle : {0.0, 0.4, 1.1, 1.570796, 2.5}) {
    SCOPED_TRACE(angle);
    expect_centroids_under(PsfKind::kGaussian, angle);
  }
  expect_centroids_under(PsfKind::kBox, 1.1);
  expect_centroids_under(PsfKind::kDisc, 1.1);
}

TEST(Centroid, StaysWithoutBlur) {
  const Camera camera = default_camera();
  Scene scene = bare_scene(kCases[2].viewpoint, camera);
  scene.optics.defocus_px = 0.0;
  expect_centroids(scene, camera, default_target(), 4);
}

TEST(Centroid, HoldsForBlackMarkersAndOtherSizes) {
  const Camera camera = default_camera();
  Target target = default_target();
  target.white_on_black = false;
  target.line.angle_deg = 12.0;
  target.ring = {28.0, 21.0};
  Scene scene = bare_scene({300, 12, 70, 25, {480.3, 530.7}}, camera);
  scene.background.level_dn = scene.light.white_dn;
  expect_centroids(scene, camera, target, 8);
}

}  // namespace
}  // namespace berth::host
