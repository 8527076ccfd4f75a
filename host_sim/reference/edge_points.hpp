// Sub-pixel places of a marker's edge, along the normals of its predicted outline.
//
// On each profile the edge is where the grey level crosses the middle between the levels at both
// ends, these averaged over neighbouring profiles: a shadow or a light gradient across the marker
// moves the levels, not the crossing.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace berth::host {

struct EdgeSearch {
  double bright_px = 4;          ///< how far the profile reaches to the marker's side
  double dark_px = 4;            ///< and to the other
  bool is_bright_inside = true;  ///< false for the ring's inner edge
  bool is_closed = true;         ///< the outline's last point is followed by its first
};

struct LocatedEdge {
  std::vector<cv::Point2d> points;
  /// Standard deviation of the blur across the edge, from the slope at the crossings.
  double blur_px = 0;
};

/// Edge points in pixels of the (distorted) image `flat` (flatten.hpp). `outline` runs from x
/// towards y, about a pixel from point to point. Profiles without a clear edge are left out.
LocatedEdge locate_edge(const cv::Mat1f& flat, const std::vector<cv::Point2d>& outline,
                        const EdgeSearch& search);

}  // namespace berth::host
