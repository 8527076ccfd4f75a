// Removes uneven light: grey levels as a share of the contrast between white and black there.
//
// White and black are planes over the image, fitted robustly to the target's own white and black
// places. Without it a blurred edge in a light gradient g per px, whose levels are taken h px away,
// is misplaced by about 1.25 g h sigma, on all markers towards the same side.
#pragma once

#include <opencv2/core.hpp>

#include "host_sim/io/camera_model.hpp"
#include "host_sim/io/target_file.hpp"
#include "host_sim/reference/rigid.hpp"

namespace berth::host {

/// 0 where black, 100 where white, in the part of the image where the target is predicted and
/// around it; `gray` is float with bright markers.
cv::Mat1f flatten_light(const cv::Mat1f& gray, const Camera& camera, const Target& target,
                        const Rigid& predicted);

}  // namespace berth::host
