// Camera calibration files (OpenCV's YAML) for the host programs.
#pragma once

#include <string>
#include <tl/expected.hpp>

#include "host_sim/io/camera_model.hpp"

namespace berth::host {

inline constexpr int kLargestFirmwareImage_px = 1024;
inline constexpr int kLargestHostImage_px = 8192;

/// Which image sizes to accept: the host renders and bins images that the firmware cannot take.
enum class CameraUse { kFirmware, kHost };

/// Reads a camera: image_width, image_height, camera_matrix, distortion_coefficients (4 or 5
/// values in a row or a column, more only when zero). The error is one line that names the file,
/// the key and the cure.
tl::expected<Camera, std::string> load_camera(const std::string& path,
                                              CameraUse use = CameraUse::kHost);

/// The same from text in memory; `name` stands for the file in error lines.
tl::expected<Camera, std::string> parse_camera(const std::string& text, const std::string& name,
                                               CameraUse use = CameraUse::kHost);

/// HEC-1, built into the program.
Camera default_camera();

}  // namespace berth::host
