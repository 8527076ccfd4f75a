// What stage 5 measures: markers located in the image.
#pragma once

#include <cstdint>

#include "camera/camera.hpp"
#include "target/model.hpp"

namespace berth {

/// One located marker, in pixels of the (distorted) image.
enum class MarkerKind : std::uint8_t { kDot = 0, kRing = 1, kLine = 2 };

struct Marker {
  MarkerKind kind = MarkerKind::kDot;
  std::uint8_t index = 0;          // which dot
  bool located = false;            // measured in the image
  bool used = false;               // took part in the final pose
  Vec2Px center_px{Px(0), Px(0)};  // measured area centroid
  Vec2Px bias_px{Px(0), Px(0)};    // centroid of the projected outline minus projected centre
  // Variance of the centroid, px^2, Q<24>: xx, xy, yy.
  Q<24> variance_xx, variance_xy, variance_yy;
};

constexpr int kMaxMarkers = kMaxDots + 2;

struct MarkerSet {
  std::int32_t count = 0;
  Marker markers[kMaxMarkers];  // the dots in the model's order, then the ring, then the line
};

}  // namespace berth
