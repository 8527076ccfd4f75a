// The two fixed transforms of a berthing: hand-eye calibration and mounting of the target.
#pragma once

#include <Eigen/Core>
#include <string>
#include <tl/expected.hpp>

namespace berth::host {

/// Homogeneous transforms, translations in mm; T_EL = T_EC T_CT T_TL.
struct Mount {
  Eigen::Matrix4d T_EC = Eigen::Matrix4d::Identity();  ///< tool from camera
  Eigen::Matrix4d T_TL = Eigen::Matrix4d::Identity();  ///< target from latch
};

/// Reads T_EC and T_TL (4 x 4 matrices in OpenCV YAML); one that is missing is the identity, but
/// a file with neither is refused. The error is one line with file, key and cure.
tl::expected<Mount, std::string> load_mount(const std::string& path);

/// The same from text in memory; `name` stands for the file in error lines.
tl::expected<Mount, std::string> parse_mount(const std::string& text, const std::string& name);

}  // namespace berth::host
