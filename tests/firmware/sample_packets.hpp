// Packets with a different value in every field, for round trips.
#pragma once

#include <random>

#include "tmtc/packet_fields.hpp"
#include "tmtc/packets.hpp"

namespace berth::test {

/// Fills every field that a visitor hands it with random bits.
class RandomIo {
 public:
  explicit RandomIo(unsigned seed) : random_(seed) {}

  template <typename Integer>
  void operator()(Integer& value) {
    value = static_cast<Integer>(static_cast<std::uint64_t>(random_()) << 32 | random_());
  }
  template <int F>
  void operator()(Q<F>& value) {
    value = Q<F>::from_raw(static_cast<std::int32_t>(random_()));
  }

 private:
  std::mt19937 random_;
};

inline PosePacket random_pose(unsigned seed) {
  PosePacket p;
  RandomIo io(seed);
  std::uint8_t flags = 0, reason = 0;
  visit_pose(io, p, flags, reason);
  p.valid = (flags & 1) != 0;
  p.identified = (flags & 2) != 0;
  p.has_pose = (flags & 4) != 0;
  p.has_second = (flags & 8) != 0;
  p.reason = static_cast<Reason>(reason % static_cast<int>(Reason::kCount));
  return p;
}

inline MarkersPacket random_markers(unsigned seed, int count) {
  MarkersPacket p;
  RandomIo io(seed);
  io(p.frame_index);
  p.set.count = count;
  for (int i = 0; i < count; ++i) {
    Marker& marker = p.set.markers[i];
    std::uint8_t kind = 0, flags = 0;
    visit_marker(io, marker, kind, flags);
    marker.kind = static_cast<MarkerKind>(kind % 3);
    marker.located = (flags & 1) != 0;
    marker.used = (flags & 2) != 0;
  }
  return p;
}

template <typename Packet, typename Visit>
Packet random_packet(unsigned seed, Visit visit) {
  Packet p;
  RandomIo io(seed);
  visit(io, p);
  return p;
}

}  // namespace berth::test
