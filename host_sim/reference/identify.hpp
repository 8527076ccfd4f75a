// The target among the blobs: a ring, then its roll from the dots, then the grey levels.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "host_sim/io/camera_model.hpp"
#include "host_sim/io/target_file.hpp"
#include "host_sim/reference/blobs.hpp"
#include "host_sim/reference/rigid.hpp"

namespace berth::host {

/// A pose good to a few pixels, or nothing. `gray` is 8 bit with bright markers.
std::optional<Rigid> identify_target(const cv::Mat& gray, const Camera& camera,
                                     const Target& target, const std::vector<Blob>& blobs);

}  // namespace berth::host
