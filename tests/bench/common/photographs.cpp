#include "bench/common/photographs.hpp"

#include <filesystem>
#include <map>
#include <opencv2/imgcodecs.hpp>

namespace berth::bench {
namespace {

namespace fs = std::filesystem;

bool is_photograph(const fs::directory_entry& entry) {
  const std::string kind = entry.path().extension().string();
  return entry.is_regular_file() && entry.path().stem() != "screenshot" &&
         (kind == ".jpg" || kind == ".jpeg" || kind == ".png");
}

cv::Mat middle_of(const std::string& path, int side) {
  const cv::Mat photo = cv::imread(path, cv::IMREAD_GRAYSCALE);
  if (photo.cols < side || photo.rows < side) return {};
  return photo({(photo.cols - side) / 2, (photo.rows - side) / 2, side, side}).clone();
}

}  // namespace

std::vector<Photograph> photograph_crops(const std::string& folder, int side) {
  std::map<std::string, std::multimap<std::uintmax_t, std::string>> files;  // by folder and size
  std::error_code failure;
  for (fs::recursive_directory_iterator it(folder, failure), end; !failure && it != end;
       it.increment(failure)) {
    if (!is_photograph(*it)) continue;
    files[it->path().parent_path().string()].emplace(it->file_size(), it->path().string());
  }
  std::vector<Photograph> crops;
  for (const auto& [parent, by_size] : files) {
    for (const auto& [bytes, path] : by_size) {
      const cv::Mat crop = middle_of(path, side);
      if (crop.empty()) continue;
      crops.push_back({path, crop});
      break;
    }
  }
  return crops;
}

}  // namespace berth::bench
