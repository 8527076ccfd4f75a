// A plain randomized Hough transform for circles (Xu, Oja, Kultanen 1990).
//
// Three random edge points give one circle; equal circles are counted in a list instead of an
// accumulator; one that comes up often enough is confirmed on the edge image, reported, and its
// points are taken away.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace berth::bench {

struct RandomizedHoughOptions {
  int radius_min = 20, radius_max = 150;
  int trials = 300000;
  int hits = 3;          // equal circles before one is confirmed
  double cell_px = 4;    // circles are equal when their centre and radius fall into one cell
  double support = 0.5;  // share of the circle on edge points within a pixel
};

/// x, y, radius of the circles in an edge image; the same for the same seed.
std::vector<cv::Vec3d> randomized_hough(const cv::Mat& edges, const RandomizedHoughOptions& options,
                                        std::uint64_t seed);

}  // namespace berth::bench
