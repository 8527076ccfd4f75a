// The text of data/camera_hec1.yaml and data/target_ct1.yaml, built into the program so that it
// runs from any folder. The build generates the source from those files.
#pragma once

#include <string>

namespace berth::host {

std::string default_camera_yaml();
std::string default_target_yaml();

}  // namespace berth::host
