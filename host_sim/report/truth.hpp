// Ground truth of rendered images: truth.csv as `berthmark render` writes it.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <tl/expected.hpp>

namespace berth::host {

/// A pose in double: p_camera = rotation * p_target + translation_mm.
struct DoublePose {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation_mm = Eigen::Vector3d::Zero();
};

/// A row of truth.csv: the pose (none without a target) and the scene's fields by column name.
struct TruthRow {
  std::optional<DoublePose> pose;
  std::map<std::string, std::string> scene;

  /// A scene number; nothing where the column is missing, empty or text.
  std::optional<double> number(const std::string& column) const;
  /// A scene field as it stands; empty where the column is missing.
  std::string text(const std::string& column) const;
};

using Truth = std::map<std::string, TruthRow>;  // by the `file` column

/// Reads a truth.csv; the error names the file, the row and the cure.
tl::expected<Truth, std::string> load_truth(const std::filesystem::path& path);

}  // namespace berth::host
