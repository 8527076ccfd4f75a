// Where the true edges of a rendered scene lie, and how a detector's chains compare with them.
#pragma once

#include <array>
#include <vector>

#include "bench/edges/measures.hpp"
#include "bench/edges/pixel_chains.hpp"
#include "host_sim/io/camera_model.hpp"
#include "host_sim/io/target_file.hpp"
#include "host_sim/render/scene.hpp"

namespace berth::bench {

/// A closed outline as points a quarter of a pixel apart, from the renderer's geometry.
struct TrueContour {
  std::vector<cv::Point2d> points_px;
  std::vector<char> is_visible;  // not hidden by collar, post or occluder, nor within 3 px of them
  int arcs() const;              // visible runs: as many pieces as a perfect detector delivers
};

/// Outlines of ring, line and dots. The plate's border is left out: what lies behind it may be as
/// dark as the plate.
std::vector<TrueContour> true_contours(const host::Scene& scene, const host::Camera& camera,
                                       const host::Target& target);

/// Distances in bins of 1/100 px, so that tallies of frames can be merged.
struct DistanceTally {
  std::array<long, 201> bins{};
  Mean mean;
  void add(double distance_px);
  void merge(const DistanceTally& other);
  double quantile(double share) const;
};

struct TruthTally {
  Mean found;              // of the visible outline
  DistanceTally places;    // as delivered
  DistanceTally pixels;    // from the centres of the integer pixels
  Mean pieces;             // chains per visible arc, of contours of which half is found
  Mean turning;            // degrees per pixel along the true outline, of integer pixels
  Mean turning_of_places;  // the same, of places as delivered
  void merge(const TruthTally& other);
};

/// Pixels within 2 px of a visible outline count as its own.
inline constexpr double kReach_px = 2.0;

/// The outlines themselves, rounded to pixels: what no detector of pixels can surpass.
Detection round_outlines(const std::vector<TrueContour>& contours, cv::Size frame);

TruthTally compare(const Detection& detection, const std::vector<TrueContour>& contours);

}  // namespace berth::bench
