#include "accuracy/tag_readers.hpp"

#include <apriltag/apriltag.h>
#include <apriltag/common/zarray.h>
#include <apriltag/tag36h11.h>

#include <opencv2/aruco.hpp>
#include <opencv2/calib3d.hpp>
#include <vector>

namespace berth::accuracy {
namespace {

// One detector for the process: building its tables takes longer than a frame.
struct Apriltag {
  apriltag_detector_t* detector = apriltag_detector_create();
  apriltag_family_t* family = tag36h11_create();
  Apriltag() {
    apriltag_detector_add_family(detector, family);
    detector->quad_decimate = 1;
    detector->refine_edges = true;
    detector->nthreads = 1;
  }
  ~Apriltag() {
    apriltag_detector_destroy(detector);
    tag36h11_destroy(family);
  }
};

int method_of(ArucoRefinement refinement) {
  switch (refinement) {
    case ArucoRefinement::kSubpixel:
      return cv::aruco::CORNER_REFINE_SUBPIX;
    case ArucoRefinement::kContour:
      return cv::aruco::CORNER_REFINE_CONTOUR;
    case ArucoRefinement::kApriltag:
      break;
  }
  return cv::aruco::CORNER_REFINE_APRILTAG;
}

host::Pose to_pose(const cv::Mat& rotation, const cv::Mat& translation) {
  cv::Matx33d r;
  cv::Rodrigues(rotation, r);
  host::Pose pose;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) pose.R(i, k) = r(i, k);
    pose.t[i] = translation.at<double>(i);
  }
  return pose;
}

}  // namespace

std::optional<TagCorners> read_apriltag(const host::Image8& image) {
  static Apriltag tags;
  std::vector<uint8_t> copy = image.data;
  image_u8_t view{image.width, image.height, image.width, copy.data()};
  zarray_t* found = apriltag_detector_detect(tags.detector, &view);
  std::optional<TagCorners> corners;
  for (int i = 0; i < zarray_size(found); ++i) {
    apriltag_detection_t* detection = nullptr;
    zarray_get(found, i, &detection);
    if (detection->id != 0) continue;
    // Counter-clockwise from the lower left; the centre of the first pixel is (0.5, 0.5).
    TagCorners c;
    for (size_t k = 0; k < 4; ++k) {
      c[k] = {detection->p[3 - k][0] - 0.5, detection->p[3 - k][1] - 0.5};
    }
    corners = c;
  }
  apriltag_detections_destroy(found);
  return corners;
}

std::optional<TagCorners> read_aruco(const host::Image8& image, ArucoRefinement refinement) {
  static const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_APRILTAG_36h11);
  auto parameters = cv::aruco::DetectorParameters::create();
  parameters->cornerRefinementMethod = method_of(refinement);
  // By default the margin's outline crowds out the tag's own, one cell away.
  parameters->minMarkerDistanceRate = 0.005;
  const cv::Mat view(image.height, image.width, CV_8U, const_cast<uint8_t*>(image.data.data()));
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<int> ids;
  cv::aruco::detectMarkers(view, dictionary, corners, ids, parameters);
  for (size_t i = 0; i < ids.size(); ++i) {
    if (ids[i] != 0) continue;
    // Its AprilTag refinement keeps AprilTag's half pixel, of which 0.455 px are left in the mean.
    const double shift = refinement == ArucoRefinement::kApriltag ? 0.455 : 0;
    TagCorners c;
    for (size_t k = 0; k < 4; ++k) c[k] = {corners[i][k].x - shift, corners[i][k].y - shift};
    return c;
  }
  return std::nullopt;
}

host::Pose pose_from_corners(const TagCorners& corners, const TagPattern& tag,
                             const host::Camera& camera, const host::Pose& truth) {
  const cv::Matx33d k(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  const std::vector<double> distortion{camera.k1, camera.k2, camera.p1, camera.p2, camera.k3};
  std::vector<cv::Point2d> seen;
  for (const Eigen::Vector2d& c : corners) seen.emplace_back(c.x(), c.y());
  host::Pose best;
  double least = 1e9;
  // Readers differ in which corner comes first and which way round.
  for (int turn = 0; turn < 8; ++turn) {
    std::vector<cv::Point3d> places;
    for (int i = 0; i < 4; ++i) {
      const int from = turn < 4 ? (i + turn) % 4 : (11 - i - turn) % 4;
      const Eigen::Vector3d p = tag.corners()[static_cast<size_t>(from)];
      places.emplace_back(p.x(), p.y(), p.z());
    }
    std::vector<cv::Mat> rotations, translations;
    cv::solvePnPGeneric(places, seen, k, distortion, rotations, translations, false,
                        cv::SOLVEPNP_IPPE);
    for (size_t i = 0; i < rotations.size(); ++i) {
      cv::solvePnPRefineLM(places, seen, k, distortion, rotations[i], translations[i]);
      const host::Pose pose = to_pose(rotations[i], translations[i]);
      const double off = Eigen::AngleAxisd(pose.R * truth.R.transpose()).angle();
      if (off < least) {
        least = off;
        best = pose;
      }
    }
  }
  return best;
}

}  // namespace berth::accuracy
