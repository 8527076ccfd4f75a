#include "host_sim/io/mount_file.hpp"

#include <Eigen/LU>

#include "host_sim/io/yaml_text.hpp"

namespace berth::host {
namespace {

// Files carry six to nine decimals; anything worse is a typing error, not rounding.
constexpr double kOrthonormalTolerance = 1e-5;

tl::expected<Eigen::Matrix4d, std::string> read_transform(const YamlText& yaml,
                                                          const std::string& key) {
  if (yaml.storage[key].empty()) return Eigen::Matrix4d(Eigen::Matrix4d::Identity());
  const auto matrix = read_matrix(yaml, key);
  if (!matrix) return tl::make_unexpected(matrix.error());
  if (matrix->rows != 4 || matrix->cols != 4) return yaml_error(yaml, key, "must be 4 x 4");
  Eigen::Matrix4d transform;
  for (int row = 0; row < 4; ++row) {
    for (int col = 0; col < 4; ++col) transform(row, col) = (*matrix)(row, col);
  }
  if (transform.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
    return yaml_error(yaml, key, "the last row must be 0 0 0 1");
  }
  const Eigen::Matrix3d R = transform.topLeftCorner<3, 3>();
  const Eigen::Matrix3d excess = R * R.transpose() - Eigen::Matrix3d::Identity();
  if (excess.cwiseAbs().maxCoeff() > kOrthonormalTolerance || R.determinant() < 0.0) {
    return yaml_error(yaml, key, "its rotation is not orthonormal and right-handed; correct it");
  }
  return transform;
}

}  // namespace

tl::expected<Mount, std::string> parse_mount(const std::string& text, const std::string& name) {
  const auto yaml = parse_yaml(text, name);
  if (!yaml) return tl::make_unexpected(yaml.error());
  if (yaml->storage["T_EC"].empty() && yaml->storage["T_TL"].empty()) {
    return yaml_error(*yaml, "T_EC", "and T_TL are both missing; add them as 4 x 4 matrices");
  }
  const auto hand_eye = read_transform(*yaml, "T_EC");
  if (!hand_eye) return tl::make_unexpected(hand_eye.error());
  const auto mounting = read_transform(*yaml, "T_TL");
  if (!mounting) return tl::make_unexpected(mounting.error());
  return Mount{*hand_eye, *mounting};
}

tl::expected<Mount, std::string> load_mount(const std::string& path) {
  const auto text = read_text(path);
  if (!text) return tl::make_unexpected(text.error());
  return parse_mount(*text, path);
}

}  // namespace berth::host
