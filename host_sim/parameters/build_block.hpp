// The parameter block from the host's descriptions of camera, target and mounting.
#pragma once

#include <cstdint>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "host_sim/io/camera_model.hpp"
#include "host_sim/io/mount_file.hpp"
#include "host_sim/io/target_file.hpp"
#include "pipeline/parameters.hpp"

namespace berth::host {

/// The flight parameters nearest to the descriptions: every value rounded to its Q format,
/// rotations replaced by the nearest orthonormal ones before rounding. Thresholds are the defaults.
/// The error is one line that names the value which does not fit its format or is out of range.
tl::expected<berth::Parameters, std::string> make_parameters(const Camera& camera,
                                                             const Target& target,
                                                             const Mount& mount = {},
                                                             const Mode& mode = {});

/// The same as a parameter block, proven by decoding it again.
tl::expected<std::vector<std::uint8_t>, std::string> build_parameter_block(const Camera& camera,
                                                                           const Target& target,
                                                                           const Mount& mount = {},
                                                                           const Mode& mode = {});

}  // namespace berth::host
