#include "host_sim/report/frame_record.hpp"

namespace berth::host {

std::string marker_name(const Marker& marker) {
  switch (marker.kind) {
    case MarkerKind::kDot:
      return "D" + std::to_string(marker.index);
    case MarkerKind::kRing:
      return "ring";
    case MarkerKind::kLine:
      return "line";
  }
  return "unknown";
}

}  // namespace berth::host
