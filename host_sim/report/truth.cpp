#include "host_sim/report/truth.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <vector>

namespace berth::host {
namespace {

using Fields = std::vector<std::string>;

/// Splits a CSV line; quoted fields may hold commas and doubled quotes.
Fields split(const std::string& line) {
  Fields fields(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"') {
      if (quoted && i + 1 < line.size() && line[i + 1] == '"')
        fields.back() += line[++i];
      else
        quoted = !quoted;
    } else if (c == ',' && !quoted) {
      fields.emplace_back();
    } else if (c != '\r') {
      fields.back() += c;
    }
  }
  return fields;
}

constexpr std::array kPoseColumns = {"tx_mm", "ty_mm", "tz_mm", "qw", "qx", "qy", "qz"};

std::optional<DoublePose> pose_of(const TruthRow& row) {
  std::array<double, 7> v{};
  for (std::size_t i = 0; i < v.size(); ++i) {
    const auto value = row.number(kPoseColumns[i]);
    if (!value) return std::nullopt;
    v[i] = *value;
  }
  DoublePose pose;
  pose.translation_mm = {v[0], v[1], v[2]};
  pose.rotation = Eigen::Quaterniond(v[3], v[4], v[5], v[6]).normalized();
  return pose;
}

}  // namespace

std::optional<double> TruthRow::number(const std::string& column) const {
  const std::string field = text(column);
  if (field.empty()) return std::nullopt;
  char* end = nullptr;
  const double value = std::strtod(field.c_str(), &end);
  if (*end != '\0') return std::nullopt;
  return value;
}

std::string TruthRow::text(const std::string& column) const {
  const auto found = scene.find(column);
  return found == scene.end() ? std::string() : found->second;
}

tl::expected<Truth, std::string> load_truth(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::string line;
  if (!file || !std::getline(file, line)) {
    return tl::unexpected(
        fmt::format("{}: cannot be read; give the truth.csv that `berthmark "
                    "render` wrote beside the images",
                    path.string()));
  }
  const Fields header = split(line);
  for (const char* needed : {"file", "tx_mm", "ty_mm", "tz_mm", "qw", "qx", "qy", "qz"}) {
    if (std::find(header.begin(), header.end(), needed) == header.end()) {
      return tl::unexpected(
          fmt::format("{}: no column \"{}\"; give the truth.csv that `berthmark "
                      "render` wrote",
                      path.string(), needed));
    }
  }
  Truth truth;
  for (std::size_t row = 2; std::getline(file, line); ++row) {
    if (line.empty()) continue;
    const Fields fields = split(line);
    if (fields.size() != header.size()) {
      return tl::unexpected(fmt::format("{}: line {} has {} fields instead of {}; render again",
                                        path.string(), row, fields.size(), header.size()));
    }
    TruthRow out;
    for (std::size_t i = 0; i < header.size(); ++i) {
      out.scene[header[i]] = fields[i];
    }
    out.pose = pose_of(out);
    truth[out.text("file")] = out;
  }
  return truth;
}

}  // namespace berth::host
