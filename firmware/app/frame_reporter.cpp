#include "app/frame_reporter.hpp"

#include "pose/frames.hpp"

namespace berth {
namespace {

WireTransform to_wire(const RigidTransform& transform) {
  WireTransform wire;
  for (int axis = 0; axis < 3; ++axis) wire.translation_mm[axis] = transform.translation_mm[axis];
  wire.rotation = quaternion_of(transform.rotation);
  return wire;
}

}  // namespace

PosePacket make_pose_packet(std::uint32_t frame_index, const FrameResult& result) {
  PosePacket packet;
  packet.frame_index = frame_index;
  packet.valid = result.valid;
  packet.identified = result.identified;
  packet.has_pose = result.has_pose;
  packet.reason = result.reason;
  if (!result.has_pose) return packet;
  const PoseEstimate& pose = result.pose;
  packet.markers_used = static_cast<std::uint8_t>(pose.markers_used);
  packet.camera_from_target = to_wire(pose.camera_from_target);
  packet.covariance = pose.covariance;
  packet.residual_px = pose.residual_px;
  packet.ambiguity = pose.ambiguity;
  packet.effector_from_latch = to_wire(result.effector_from_latch);
  packet.effector_covariance = result.effector_covariance;
  packet.has_second = pose.has_second;
  if (!pose.has_second) return packet;
  packet.second = to_wire(pose.second);
  packet.second_residual_px = pose.second_residual_px;
  return packet;
}

AlgorithmPacket make_algorithm_packet(std::uint32_t frame_index, const FrameResult& result) {
  AlgorithmPacket packet;
  packet.frame_index = frame_index;
  for (int s = 0; s < kStageCount; ++s) packet.digests[s] = result.digests[s];
  packet.work_units = result.work_units;
  packet.tally = result.tally;
  for (int axis = 0; axis < 2; ++axis) packet.ring_center_px[axis] = result.ring_center_px[axis];
  packet.ring_radius_px = result.ring_radius_px;
  packet.roll = result.roll;
  return packet;
}

void FrameReporter::report(const hal::CameraFrame& frame, const FrameResult& result,
                           LineWriter& line) {
  const CucTime time = cuc_from_us(frame.mid_exposure_us);
  const auto send = [&](PacketType type, std::int32_t source_bytes) {
    line.append(channel_.next_header(type, time), source_bytes);
  };
  send(kPoseType, encode_pose(make_pose_packet(frame.index, result), line.source()));
  send(kMarkersType, encode_markers({frame.index, result.markers}, line.source()));
  send(kAlgorithmType, encode_algorithm(make_algorithm_packet(frame.index, result), line.source()));
  if (result.valid) return;
  const FrameEventPacket event{frame.index, result.reason, result.work_units};
  send(kFrameEventType, encode_frame_event(event, line.source()));
}

}  // namespace berth
