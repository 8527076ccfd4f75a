// Width and smoothness of edge chains, from their integer pixels.
#pragma once

#include "bench/edges/pixel_chains.hpp"

namespace berth::bench {

/// A mean that can be merged.
struct Mean {
  double sum = 0, weight = 0;
  void add(double value) { sum += value, weight += 1; }
  void merge(const Mean& other) { sum += other.sum, weight += other.weight; }
  double value() const { return weight > 0 ? sum / weight : 0; }
};

/// Share of the pixels that are part of a 2 x 2 block of edge pixels: 0 where every line is one
/// pixel wide. Each pixel of the grid counts once, however many chains run over it.
Mean block_share(const Detection& detection);

inline constexpr int kBaseline = 5;  // pixels

/// Mean absolute change, in degrees, of the chain's direction from a pixel to the next; direction
/// is that of the chord over kBaseline pixels. A straight line along an axis or a diagonal has 0, a
/// circle of radius R at least 57.3 / R; what is above is roughness. Chains of less than three
/// baselines do not count.
Mean turning_deg(const std::vector<cv::Point>& pixels);
Mean turning_deg(const std::vector<cv::Point2d>& places_px);
Mean turning_deg(const Detection& detection);

}  // namespace berth::bench
