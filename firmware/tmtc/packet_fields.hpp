// The fields of each packet in their order on the wire: one list for both directions.
// `Io` is a FieldWriter or a FieldReader; it is called with each field in turn.
#pragma once

#include <cstdint>

#include "tmtc/byte_order.hpp"
#include "tmtc/packets.hpp"

namespace berth {

class FieldWriter {
 public:
  explicit FieldWriter(Span<std::uint8_t> source) : out_(source) {}

  void operator()(std::uint8_t value) { out_.u8(value); }
  void operator()(std::uint16_t value) { out_.u16(value); }
  void operator()(std::uint32_t value) { out_.u32(value); }
  void operator()(std::uint64_t value) { out_.u64(value); }
  template <int F>
  void operator()(Q<F> value) {
    out_.q(value);
  }
  /// Octets written, 0 when they did not all fit.
  std::int32_t finish() const { return out_.has_overflowed() ? 0 : out_.size(); }

 private:
  ByteWriter out_;
};

class FieldReader {
 public:
  explicit FieldReader(Span<const std::uint8_t> source) : in_(source) {}

  void operator()(std::uint8_t& value) { value = in_.u8(); }
  void operator()(std::uint16_t& value) { value = in_.u16(); }
  void operator()(std::uint32_t& value) { value = in_.u32(); }
  void operator()(std::uint64_t& value) { value = in_.u64(); }
  template <int F>
  void operator()(Q<F>& value) {
    in_.q(value);
  }
  /// All octets taken, and none missing.
  bool finish() const { return !in_.has_run_short() && in_.remaining() == 0; }
  std::int32_t remaining() const { return in_.remaining(); }

 private:
  ByteReader in_;
};

template <typename Io, typename Transform>
void visit_transform(Io& io, Transform& t) {
  for (int axis = 0; axis < 3; ++axis) io(t.translation_mm[axis]);
  io(t.rotation.w), io(t.rotation.x), io(t.rotation.y), io(t.rotation.z);
}

template <typename Io, typename Covariance>
void visit_covariance(Io& io, Covariance& c) {
  for (int axis = 0; axis < 3; ++axis) io(c.sigma_rotation[axis]);
  for (int axis = 0; axis < 3; ++axis) io(c.sigma_translation_mm[axis]);
  for (int k = 0; k < 15; ++k) io(c.correlation[k]);
}

/// `flags` and `reason` stand for the packet's booleans and enumeration.
template <typename Io, typename Pose, typename Octet>
void visit_pose(Io& io, Pose& p, Octet& flags, Octet& reason) {
  io(p.frame_index), io(flags), io(reason), io(p.markers_used);
  visit_transform(io, p.camera_from_target);
  visit_covariance(io, p.covariance);
  io(p.residual_px), io(p.ambiguity);
  visit_transform(io, p.effector_from_latch);
  visit_covariance(io, p.effector_covariance);
  visit_transform(io, p.second);
  io(p.second_residual_px);
}

template <typename Io, typename Measured, typename Octet>
void visit_marker(Io& io, Measured& m, Octet& kind, Octet& flags) {
  io(kind), io(m.index), io(flags);
  for (int axis = 0; axis < 2; ++axis) io(m.center_px[axis]);
  io(m.variance_xx), io(m.variance_xy), io(m.variance_yy);
  for (int axis = 0; axis < 2; ++axis) io(m.bias_px[axis]);
}

template <typename Io, typename Tally>
void visit_tally(Io& io, Tally& t) {
  io(t.noise_q8), io(t.edge_threshold), io(t.edge_pixels), io(t.chains), io(t.votes);
  io(t.circle_candidates), io(t.ellipses), io(t.identified_rank), io(t.dots_located);
  io(t.pose_candidates), io(t.black), io(t.white), io(t.pools_full);
  io(t.targets);
}

template <typename Io, typename Algorithm>
void visit_algorithm(Io& io, Algorithm& a) {
  io(a.frame_index);
  for (int s = 0; s < kStageCount; ++s) io(a.digests[s]);
  io(a.work_units);
  visit_tally(io, a.tally);
  io(a.ring_center_px[0]), io(a.ring_center_px[1]), io(a.ring_radius_px), io(a.roll);
}

template <typename Io, typename Platform>
void visit_platform(Io& io, Platform& p) {
  io(p.frame_index), io(p.uptime_ticks), io(p.ticks_hz), io(p.frame_ticks);
  for (int s = 0; s < kStageCount; ++s) io(p.stage_ticks[s]);
  io(p.stack_bytes), io(p.stack_peak_bytes);
}

template <typename Io, typename Record, typename Octet>
void visit_fault(Io& io, Record& r, Octet& kind) {
  io(kind), io(r.program_counter), io(r.link_register), io(r.stack_pointer);
  io(r.fault_status), io(r.fault_address), io(r.boot_count);
}

}  // namespace berth
