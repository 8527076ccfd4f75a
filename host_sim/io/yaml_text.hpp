// Reading OpenCV YAML with one clear error line for whatever is wrong with it.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <tl/expected.hpp>

namespace berth::host {

/// An open YAML document and the name that error lines give it.
struct YamlText {
  cv::FileStorage storage;
  std::string name;
};

/// The whole file as text; the error names the file and the cure.
tl::expected<std::string, std::string> read_text(const std::string& path);

/// Parses YAML text; `name` stands for it in every error line.
tl::expected<YamlText, std::string> parse_yaml(const std::string& text, const std::string& name);

/// A finite number under `key` of `node`.
tl::expected<double, std::string> read_number(const YamlText& yaml, const cv::FileNode& node,
                                              const std::string& key);

/// Exactly `count` finite numbers under `key` of `node`.
tl::expected<std::vector<double>, std::string> read_numbers(const YamlText& yaml,
                                                            const cv::FileNode& node,
                                                            const std::string& key, size_t count);

/// A matrix (`!!opencv-matrix`) under `key`, in double precision, every element finite.
tl::expected<cv::Mat1d, std::string> read_matrix(const YamlText& yaml, const std::string& key);

/// A string under `key` of `node`.
tl::expected<std::string, std::string> read_string(const YamlText& yaml, const cv::FileNode& node,
                                                   const std::string& key);

/// "NAME: KEY: PROBLEM", the form of every error line of this folder.
tl::unexpected<std::string> yaml_error(const YamlText& yaml, const std::string& key,
                                       const std::string& problem);

}  // namespace berth::host
