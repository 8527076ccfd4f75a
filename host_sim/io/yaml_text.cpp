#include "host_sim/io/yaml_text.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace berth::host {

tl::expected<std::string, std::string> read_text(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    return tl::make_unexpected(path + ": is a folder; name a YAML file in it");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    return tl::make_unexpected(path + ": cannot be opened; check the path and its permissions");
  }
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

tl::expected<YamlText, std::string> parse_yaml(const std::string& text, const std::string& name) {
  const auto refusal = [&name] {
    return tl::make_unexpected(name + ": is not a readable YAML file; write it as OpenCV does, " +
                               "with %YAML:1.0 in the first line");
  };
  // FileStorage opens other formats and even empty text, only to throw at the first access.
  if (text.rfind("%YAML", 0) != 0) return refusal();
  try {
    YamlText yaml{cv::FileStorage(text, cv::FileStorage::READ | cv::FileStorage::MEMORY), name};
    if (!yaml.storage.isOpened() || !yaml.storage.root().isMap()) return refusal();
    return yaml;
  } catch (const cv::Exception&) {
    return refusal();
  }
}

tl::unexpected<std::string> yaml_error(const YamlText& yaml, const std::string& key,
                                       const std::string& problem) {
  return tl::make_unexpected(yaml.name + ": " + key + ": " + problem);
}

tl::expected<double, std::string> read_number(const YamlText& yaml, const cv::FileNode& node,
                                              const std::string& key) {
  const cv::FileNode value = node.isMap() ? node[key] : cv::FileNode();
  if (value.empty()) return yaml_error(yaml, key, "is missing; add it with a number");
  if (!value.isReal() && !value.isInt()) return yaml_error(yaml, key, "must be a number");
  const double number = value.real();
  if (!std::isfinite(number)) return yaml_error(yaml, key, "must be a finite number");
  return number;
}

tl::expected<std::vector<double>, std::string> read_numbers(const YamlText& yaml,
                                                            const cv::FileNode& node,
                                                            const std::string& key, size_t count) {
  const std::string wanted = "a list of " + std::to_string(count) + " numbers";
  const cv::FileNode list = node.isMap() ? node[key] : cv::FileNode();
  if (list.empty()) return yaml_error(yaml, key, "is missing; add it with " + wanted);
  if (!list.isSeq() || list.size() != count) return yaml_error(yaml, key, "must be " + wanted);
  std::vector<double> numbers;
  for (const cv::FileNode& value : list) {
    if ((!value.isReal() && !value.isInt()) || !std::isfinite(value.real())) {
      return yaml_error(yaml, key, "must be " + wanted + ", all finite");
    }
    numbers.push_back(value.real());
  }
  return numbers;
}

tl::expected<cv::Mat1d, std::string> read_matrix(const YamlText& yaml, const std::string& key) {
  const cv::FileNode node = yaml.storage[key];
  if (node.empty()) return yaml_error(yaml, key, "is missing; add it as an !!opencv-matrix");
  cv::Mat matrix;
  try {
    node >> matrix;
  } catch (const cv::Exception&) {
    matrix.release();
  }
  if (matrix.empty() || matrix.channels() != 1) {
    return yaml_error(yaml, key, "must be an !!opencv-matrix with rows, cols, dt and data");
  }
  cv::Mat1d result;
  matrix.convertTo(result, CV_64F);
  for (const double value : result) {
    if (!std::isfinite(value)) return yaml_error(yaml, key, "must hold finite numbers only");
  }
  return result;
}

tl::expected<std::string, std::string> read_string(const YamlText& yaml, const cv::FileNode& node,
                                                   const std::string& key) {
  const cv::FileNode value = node.isMap() ? node[key] : cv::FileNode();
  if (value.empty()) return yaml_error(yaml, key, "is missing; add it with a text");
  if (!value.isString()) return yaml_error(yaml, key, "must be a text");
  return value.string();
}

}  // namespace berth::host
