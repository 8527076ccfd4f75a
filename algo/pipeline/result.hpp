// What one frame gives: a pose or a reason, the tallies of every stage and their digests.
#pragma once

#include <cstdint>

#include "core/reason.hpp"
#include "pose/image_blur.hpp"
#include "pose/pose.hpp"

namespace berth {

/// The stages in the order they run; also the order of digests, tallies and instruction counts.
enum class Stage : std::uint8_t {
  kEdges = 0,  // binning, smoothing, gradient, anchors
  kLink,       // edge chains
  kCircles,    // isophote votes, ellipse fits
  kIdentify,   // line test and layout
  kReference,  // grey reference values
  kMarkers,    // region growing, centroids
  kPose,       // P3P and selection
  kRefine,     // refinement, covariance, tool frame
  kCount
};
constexpr int kStageCount = static_cast<int>(Stage::kCount);

/// Name in snake case for reports ("edges", "link", ...).
const char* stage_name(Stage stage);

/// What happened on the way: counts that telemetry carries.
struct FrameTally {
  std::uint16_t noise_q8 = 0;        // measured sensor noise, DN, Q8
  std::uint16_t edge_threshold = 0;  // gradient units of the search image
  std::uint16_t edge_pixels = 0;
  std::uint16_t chains = 0;
  std::uint16_t votes = 0;
  std::uint16_t circle_candidates = 0;
  std::uint16_t ellipses = 0;  // candidates that an ellipse fit confirmed
  std::uint16_t identified_rank =
      0;  // which of them was the target, from 1; 0: none, or none needed
  std::uint16_t dots_located = 0;
  std::uint16_t pose_candidates = 0;
  std::uint8_t black = 0, white = 0;  // reference values, DN
  std::uint8_t targets = 0;     // rings with line and dots: two and more, the best is reported
  std::uint8_t pools_full = 0;  // bit per pool: 0 edge pixels, 1 chains, 2 candidates
};

struct FrameResult {
  bool valid = false;
  bool identified = false;  // stage 3 accepted a target, and its outlines do not refute it
  bool has_pose = false;    // a pose is reported, valid or not
  Reason reason = Reason::kBadFrame;
  Vec2Px ring_center_px{Px(0), Px(0)};  // of the pose; without one, of the ring's outline
  Px ring_radius_px;                    // semi-major axis of the ring's outer edge, likewise
  Angle roll;                           // of the target's x axis in the image, likewise
  PoseEstimate pose;                    // camera_from_target
  ImageBlur blur = kUnknownBlur;        // of the outlines
  RigidTransform effector_from_latch;   // T_EL
  PoseCovariance effector_covariance;
  MarkerSet markers;
  FrameTally tally;
  std::uint32_t digests[kStageCount] = {};
  std::uint32_t work_units = 0;
};

}  // namespace berth
