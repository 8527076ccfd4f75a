// What the stages found in a frame, as the overlay draws it: plain polylines in image pixels.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "pipeline/workspace.hpp"

namespace berth::host {

using Polyline = std::vector<cv::Point2d>;

struct Trace {
  std::vector<Polyline> chains;    // linked edges
  std::vector<Polyline> ellipses;  // confirmed ring candidates, closed
};

/// This file is the only place of the host that knows how the workspace keeps what it found.
Trace read_trace(const Workspace& workspace);

/// Forgets the frame before: a frame that ends early leaves the later stages' results alone.
void clear_trace(Workspace& workspace);

}  // namespace berth::host
