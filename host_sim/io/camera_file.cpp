#include "host_sim/io/camera_file.hpp"

#include <cmath>

#include "host_sim/io/default_files.hpp"
#include "host_sim/io/yaml_text.hpp"

namespace berth::host {
namespace {

using Status = tl::expected<void, std::string>;

tl::expected<int, std::string> read_size(const YamlText& yaml, const std::string& key,
                                         CameraUse use) {
  const auto number = read_number(yaml, yaml.storage.root(), key);
  if (!number) return tl::make_unexpected(number.error());
  const int largest = use == CameraUse::kFirmware ? kLargestFirmwareImage_px : kLargestHostImage_px;
  if (*number != std::floor(*number) || *number < 16) {
    return yaml_error(yaml, key, "must be a whole number of at least 16 pixels");
  }
  if (*number > largest) {
    return yaml_error(yaml, key,
                      "is above " + std::to_string(largest) +
                          " pixels; bin or crop the images and calibrate for that size");
  }
  return static_cast<int>(*number);
}

Status read_sizes(const YamlText& yaml, CameraUse use, Camera& camera) {
  const auto width = read_size(yaml, "image_width", use);
  if (!width) return tl::make_unexpected(width.error());
  const auto height = read_size(yaml, "image_height", use);
  if (!height) return tl::make_unexpected(height.error());
  camera.width = *width;
  camera.height = *height;
  return {};
}

Status read_intrinsics(const YamlText& yaml, Camera& camera) {
  const std::string key = "camera_matrix";
  const auto matrix = read_matrix(yaml, key);
  if (!matrix) return tl::make_unexpected(matrix.error());
  const cv::Mat1d& k = *matrix;
  if (k.rows != 3 || k.cols != 3) return yaml_error(yaml, key, "must be 3 x 3");
  if (!(k(0, 0) > 0.0 && k(1, 1) > 0.0)) {
    return yaml_error(yaml, key, "focal lengths must be positive; calibrate again");
  }
  if (k(0, 1) != 0.0) {
    return yaml_error(yaml, key, "skew is not supported; calibrate with zero skew");
  }
  if (k(1, 0) != 0.0 || k(2, 0) != 0.0 || k(2, 1) != 0.0 || k(2, 2) != 1.0) {
    return yaml_error(yaml, key, "must have the form [fx 0 cx; 0 fy cy; 0 0 1]");
  }
  camera.fx = k(0, 0);
  camera.fy = k(1, 1);
  camera.cx = k(0, 2);
  camera.cy = k(1, 2);
  if (!(camera.cx > 0.0 && camera.cx < camera.width - 1 && camera.cy > 0.0 &&
        camera.cy < camera.height - 1)) {
    return yaml_error(yaml, key, "the principal point lies outside the image; check the size");
  }
  return {};
}

Status read_distortion_model(const YamlText& yaml) {
  const std::string key = "distortion_model";
  if (yaml.storage[key].empty()) return {};
  const auto model = read_string(yaml, yaml.storage.root(), key);
  if (!model) return tl::make_unexpected(model.error());
  // OpenCV's rational model with its further coefficients zero is the same model.
  if (*model != "plumb_bob" && *model != "rational_polynomial") {
    return yaml_error(yaml, key, "\"" + *model + "\" is not supported; calibrate as plumb_bob");
  }
  return {};
}

Status read_distortion(const YamlText& yaml, Camera& camera) {
  const std::string key = "distortion_coefficients";
  const auto matrix = read_matrix(yaml, key);
  if (!matrix) return tl::make_unexpected(matrix.error());
  const size_t count = matrix->total();
  const bool has_known_count = count == 4 || count == 5 || count == 8 || count == 12 || count == 14;
  if ((matrix->rows != 1 && matrix->cols != 1) || !has_known_count) {
    return yaml_error(yaml, key, "must be one row or column of 4 or 5 values");
  }
  const std::vector<double> d(matrix->begin(), matrix->end());
  for (size_t i = 5; i < count; ++i) {
    if (d[i] != 0.0) {
      return yaml_error(yaml, key, "values after the fifth must be zero; calibrate as plumb_bob");
    }
  }
  camera.k1 = d[0];
  camera.k2 = d[1];
  camera.p1 = d[2];
  camera.p2 = d[3];
  camera.k3 = count > 4 ? d[4] : 0.0;
  if (!is_invertible(camera)) {
    return yaml_error(yaml, key,
                      "the distortion folds over inside the image; calibrate with more points "
                      "near the corners or with fewer coefficients");
  }
  return {};
}

}  // namespace

tl::expected<Camera, std::string> parse_camera(const std::string& text, const std::string& name,
                                               CameraUse use) {
  const auto yaml = parse_yaml(text, name);
  if (!yaml) return tl::make_unexpected(yaml.error());
  Camera camera;
  camera.name = "camera";
  if (!yaml->storage["camera_name"].empty()) {
    const auto camera_name = read_string(*yaml, yaml->storage.root(), "camera_name");
    if (!camera_name) return tl::make_unexpected(camera_name.error());
    camera.name = *camera_name;
  }
  const Status status = read_sizes(*yaml, use, camera)
                            .and_then([&] { return read_intrinsics(*yaml, camera); })
                            .and_then([&] { return read_distortion_model(*yaml); })
                            .and_then([&] { return read_distortion(*yaml, camera); });
  if (!status) return tl::make_unexpected(status.error());
  return camera;
}

tl::expected<Camera, std::string> load_camera(const std::string& path, CameraUse use) {
  const auto text = read_text(path);
  if (!text) return tl::make_unexpected(text.error());
  return parse_camera(*text, path, use);
}

Camera default_camera() { return parse_camera(default_camera_yaml(), "built-in camera").value(); }

}  // namespace berth::host
