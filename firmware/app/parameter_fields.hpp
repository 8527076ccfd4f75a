// The fields of each section of the parameter block, in their order: one list for both directions.
// `Io` is a reader or a writer; it is called with each field in turn.
#pragma once

#include "pipeline/parameters.hpp"

namespace berth {

constexpr int kSectionCount = 5;
enum class Section : std::uint8_t { kCamera, kTarget, kMounts, kThresholds, kMode };
constexpr char kSectionIds[kSectionCount][5] = {"CAMR", "TRGT", "MNTS", "THRS", "MODE"};

template <typename Io, typename CameraType>
void visit_camera(Io& io, CameraType& c) {
  io(c.width), io(c.height);
  io(c.fx), io(c.fy), io(c.cx), io(c.cy);
  io(c.k1), io(c.k2), io(c.p1), io(c.p2), io(c.k3);
}

template <typename Io, typename DotType>
void visit_dot(Io& io, DotType& d) {
  for (int axis = 0; axis < 3; ++axis) io(d.center_mm[axis]);
  io(d.radius_mm), io(d.collar_radius_mm), io(d.post_radius_mm);
}

template <typename Io, typename TargetType>
void visit_target(Io& io, TargetType& t) {
  io(t.plate_width_mm), io(t.plate_height_mm), io(t.white_on_black);
  io(t.ring_outer_mm), io(t.ring_inner_mm);
  io(t.line_x_mm), io(t.line_y_mm), io(t.line_length_mm), io(t.line_width_mm), io(t.line_angle);
  io(t.dot_count);
  // A count that is out of range is refused afterwards, by name.
  for (int i = 0; i < kMaxDots; ++i) {
    if (i < t.dot_count) visit_dot(io, t.dots[i]);
  }
}

template <typename Io, typename TransformType>
void visit_transform(Io& io, TransformType& transform) {
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 3; ++col) io(transform.rotation(row, col));
  }
  for (int axis = 0; axis < 3; ++axis) io(transform.translation_mm[axis]);
}

static_assert(
    sizeof(Thresholds) == 7 * sizeof(std::int32_t),
    "a new threshold: add it below, to its check in parameter_limits.cpp and to the docs");
template <typename Io, typename ThresholdsType>
void visit_thresholds(Io& io, ThresholdsType& t) {
  io(t.false_rotation), io(t.false_translation), io(t.ambiguity_ratio);
  io(t.residual_sigmas), io(t.edge_sigmas);
  io(t.search_budget_units), io(t.frame_budget_units);
}

template <typename Io, typename ModeType>
void visit_mode(Io& io, ModeType& m) {
  io(m.track);
}

template <typename Io, typename ParametersType>
void visit_section(Io& io, Section section, ParametersType& p) {
  switch (section) {
    case Section::kCamera:
      return visit_camera(io, p.camera);
    case Section::kTarget:
      return visit_target(io, p.target);
    case Section::kMounts:
      visit_transform(io, p.effector_from_camera);
      return visit_transform(io, p.target_from_latch);
    case Section::kThresholds:
      return visit_thresholds(io, p.thresholds);
    case Section::kMode:
      return visit_mode(io, p.mode);
  }
}

}  // namespace berth
