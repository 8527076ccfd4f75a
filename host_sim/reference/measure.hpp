// Measures every marker near its predicted place and says how a pose predicts that measurement.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "host_sim/io/camera_model.hpp"
#include "host_sim/io/target_file.hpp"
#include "host_sim/reference/double_twin.hpp"

namespace berth::host {

struct MeasuredMarker {
  std::string name;         ///< of the dot, "ring_outer", "ring_inner", "line"
  Observation observation;  ///< in the ideal image
};

/// The markers that could be measured: ellipse centres of dots and of both edges of the ring, the
/// centre of the line. `flat` as flatten_light() gives it; the prediction is good to 3 px.
std::vector<MeasuredMarker> measure_markers(const cv::Mat1f& flat, const Camera& camera,
                                            const Target& target, const Rigid& predicted);

}  // namespace berth::host
