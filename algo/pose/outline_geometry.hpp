// Outlines of ring, line and dots: points along them, projected with normal, pose derivative and
// what may hide them.
//
//   p = R P + t,  u = project(p),  n unit normal of the projected outline, towards white
//   normal displacement of the outline = n . du/dp . (omega x R P + dt) = J . (omega, dt / lever)
//
// A collar in front of the plate hides, on the plate, a disc: the central projection of a disc on
// a parallel plane. With the camera at C in target coordinates, height H = -C_z above the plate and
// the collar h above it, k = H / (H - h): centre C + k (P - C), radius k r.
#pragma once

#include <cstdint>

#include "camera/camera.hpp"
#include "fixed/trigonometry.hpp"
#include "pose/pose.hpp"
#include "target/model.hpp"

namespace berth {

constexpr int kJacobianFraction = 5;
constexpr int kOutlineUnknowns = 9;  // rotation, translation / lever, edge offset

/// What makes an outline as large as it is. Two of a marker: the second has the odd number. The
/// line's width in its two halves, as one may be hidden.
enum class OutlineSize : std::int8_t {
  kNone = -1,
  kDotRadius = 0,
  kRingOuter = 2,
  kRingInner = 3,
  kFirstWidth = 4,
  kSecondWidth = 5,
  kBothWidths = 6  // of no outline alone: both halves by the same
};
constexpr int kMeasuredSizes = 6, kOutlineSizes = 7;

/// One smooth stretch of outline between two places of a marker.
struct OutlinePiece {
  bool is_arc = true;
  bool is_hole = false;                // arc: white lies outside
  Vec3Mm origin{Mm(0), Mm(0), Mm(0)};  // arc: centre; straight: first point
  Mm radius_mm;                        // arc
  Angle first_angle, step_angle;       // arc
  Mm step_x_mm, step_y_mm;             // straight, per segment
  Unit along_x, along_y;               // straight: unit vector of the step; white at its left hand
  std::int32_t segments = 0;
  OutlineSize size = OutlineSize::kNone;
  Mm width_mm;                         // to the opposite edge of the same marker
  Mm clearance_mm;                     // to the nearest other edge outside
  std::int8_t opposite_curvature = 0;  // +1: the opposite edge bends as this one does, -1, 0
  std::int8_t raised = -1;             // which raised dot this is, -1: on the plate
};

/// A point of an outline in the image.
struct OutlineVertex {
  Vec2Px point_px{Px(0), Px(0)};
  Mm place_x, place_y;       // in the target frame
  Q<16> normal_x, normal_y;  // unit, towards white
  Px width_px;               // across to the opposite edge
  Px outside_px;             // free of other edges on the black side
  bool visible = false;
  std::int32_t jacobian[6];  // of a visible one: Q<5>, px per rad and per lever
};

/// What a segment between two vertices is halfway.
struct OutlineMiddle {
  Q<16> normal_x, normal_y;  // unit
  std::int32_t jacobian[6];  // mean over the segment, Q<5>; |j| <= 1.11 2^15
};

/// The normals of an arc's ends lie on a circle and their mean within it, the normal halfway on it
/// again, and the mean over the arc, which moves a segment, between: with s = 1 - |mean of both|^2,
/// a quarter of the angle's square, to 0.001 up to 40 degrees.
OutlineMiddle middle_of(const OutlineVertex& a, const OutlineVertex& b);

/// A pose and what follows from it for the outlines.
struct OutlineView {
  const Camera* camera = nullptr;
  const TargetModel* target = nullptr;
  RigidTransform pose;
  int lever_log2 = 5;
  Mm eye_x, eye_y, eye_height;
  Px reach_px;             // half the width of a scan window: 3 sigma of the blur
  bool has_shade = false;  // a raised dot with what it hides of the plate
  Mm shade_x, shade_y, shade_collar, shade_dot, shade_post;
  Unit shade_scale_minus_one;
  Mm post_x, post_y, post_length;  // the post's run on the plate, from the dot's foot to the shade
};

/// The lever of translations and sizes is 2^this mm: the ring's radius or up to twice as much.
int lever_log2_of(const TargetModel& target);

/// Precondition: the camera is in front of the plate. reach_px: 0.5 to 12.
OutlineView make_outline_view(const Camera& camera, const TargetModel& target,
                              const RigidTransform& pose, Px reach_px);

/// The vertices of pieces, one after the other. Cost: about 800 instructions each. Known already
/// are the last one of a full circle and the first one of an arc that goes on where one of the two
/// arcs before ended. An arc's angle advances by complex multiplication, 2^-29 off after 32 steps.
class OutlineWalk {
 public:
  explicit OutlineWalk(const OutlineView& view) : view_(&view) {}
  /// `piece` is to outlive its vertices.
  void begin(const OutlinePiece& piece);
  /// Vertex 0, 1, ... up to `segments`.
  OutlineVertex next();

 private:
  // Where an arc ended.
  struct End {
    Mm radius_mm{0};
    Angle angle;
    OutlineVertex vertex;
  };
  const OutlineView* view_;
  const OutlinePiece* piece_ = nullptr;
  SinCos at_, step_;
  int index_ = 0;
  bool is_closed_ = false, goes_on_ = false;
  OutlineVertex first_;
  End ends_[2];  // the later one at [turn_]
  int turn_ = 0;
};

/// To first order where the outline goes as the pose moves by `step` (omega, dt / lever; Q<30>,
/// below 1/8): a visible vertex stays on a curve of radius r to d^2 / 2 r.
void shift_along_normal(const std::int64_t (&step)[kOutlineUnknowns], OutlineVertex& vertex);

/// d(place x, y) / d(image x, y) on the plane through a place of the target, mm per px; false where
/// the plane is seen edge-on.
bool place_by_pixel(const OutlineView& view, const Vec3Mm& place, Q<16> place_by_px[2][2]);

}  // namespace berth
