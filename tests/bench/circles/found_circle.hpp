// What a circle detector delivers, and whether it is the target's ring.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "host_sim/io/camera_model.hpp"
#include "host_sim/io/target_file.hpp"
#include "host_sim/render/scene.hpp"

namespace berth::bench {

/// A circle or an ellipse in frame pixels.
struct FoundCircle {
  cv::Point2d center;
  double major = 0, minor = 0;  // semi-axes; equal where the detector knows circles only
  bool is_circle = false;
};

/// The images of the ring's two outlines and of the dots'.
struct TrueCircles {
  std::vector<FoundCircle> ring, dots;
};

TrueCircles true_circles(const host::Scene& scene, const host::Camera& camera,
                         const host::Target& target);

/// Is it one of these outlines? The centre lies within 5 % of the larger semi-axis and both
/// semi-axes agree within 5 %, each at least 2 px. From a detector of circles a radius between the
/// semi-axes, as much widened, is enough.
bool is_one_of(const FoundCircle& found, const std::vector<FoundCircle>& outlines);

}  // namespace berth::bench
