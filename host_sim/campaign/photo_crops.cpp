#include "host_sim/campaign/photo_crops.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <mutex>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <vector>

namespace berth::host {
namespace {

namespace fs = std::filesystem;

constexpr int kSmallestSide_px = 600;  // leaves out icons and previews

bool is_picture(const fs::path& path) {
  const std::string kind = path.extension().string();
  return kind == ".jpg" || kind == ".jpeg" || kind == ".png";
}

std::vector<fs::path> pictures_below(const std::string& folder) {
  std::vector<fs::path> found;
  std::error_code failure;
  for (fs::recursive_directory_iterator it(folder, failure), end; it != end;
       it.increment(failure)) {
    if (failure) break;
    const fs::path& path = it->path();
    if (it->is_regular_file() && is_picture(path) && path.stem() != "screenshot") {
      found.push_back(path);
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

Image8 with_noise(const cv::Mat& levels_32f, double sigma_dn, uint64_t seed) {
  const std::vector<float> levels(levels_32f.begin<float>(), levels_32f.end<float>());
  return quantise(levels, levels_32f.cols, levels_32f.rows, sigma_dn, seed);
}

cv::Mat turn_randomly(const cv::Mat& image, Random& random) {
  cv::Mat turned = image;
  const int quarters = random.below(4);
  if (quarters > 0) cv::rotate(image, turned, quarters - 1);  // 90, 180, 270 degrees
  if (random.chance(0.5)) cv::flip(turned, turned, 1);
  return turned;
}

}  // namespace

struct PhotoLibrary::Pictures {
  std::vector<fs::path> paths;
  std::vector<cv::Mat> images;  // empty until read
  std::mutex mutex;

  cv::Mat get(size_t i) {
    const std::lock_guard lock(mutex);
    if (images[i].empty()) images[i] = cv::imread(paths[i].string(), cv::IMREAD_GRAYSCALE);
    if (images[i].empty()) {
      throw std::runtime_error(paths[i].string() +
                               ": cannot be read; remove it or install it anew");
    }
    return images[i];
  }
};

tl::expected<PhotoLibrary, std::string> PhotoLibrary::open(const std::string& folder) {
  auto pictures = std::make_shared<Pictures>();
  pictures->paths = pictures_below(folder);
  if (pictures->paths.empty()) {
    return tl::unexpected(
        fmt::format("{}: no photographs there; install Debian's plasma-workspace-wallpapers "
                    "(apt-get install --no-install-recommends plasma-workspace-wallpapers), or "
                    "give a folder with --photos",
                    folder));
  }
  pictures->images.resize(pictures->paths.size());
  return PhotoLibrary(std::move(pictures));
}

int PhotoLibrary::count() const { return static_cast<int>(pictures_->paths.size()); }

Image8 PhotoLibrary::crop(int width, int height, Random& random) const {
  cv::Mat photo;
  for (int tries = 0; tries < 100 && std::min(photo.cols, photo.rows) < kSmallestSide_px; ++tries) {
    photo = pictures_->get(static_cast<size_t>(random.below(count())));
  }
  const double share = std::exp(random.uniform(std::log(1.0 / 6.0), 0.0));
  const double scale = share * std::min(photo.cols / static_cast<double>(width),
                                        photo.rows / static_cast<double>(height));
  const cv::Size size(std::max(8, static_cast<int>(scale * width)),
                      std::max(8, static_cast<int>(scale * height)));
  const int left = random.below(photo.cols - size.width + 1);
  const int top = random.below(photo.rows - size.height + 1);
  cv::Mat part;
  cv::resize(photo(cv::Rect({left, top}, size)), part, {width, height}, 0, 0,
             scale > 1.0 ? cv::INTER_AREA : cv::INTER_CUBIC);
  if (width == height) part = turn_randomly(part, random);
  const double gain = std::exp(random.uniform(std::log(0.3), std::log(2.5)));
  part.convertTo(part, CV_32F, gain, random.uniform(-30.0, 30.0));
  const double noise_dn = random.uniform(0.5, 6.0);
  return with_noise(part, noise_dn, random.bits());
}

}  // namespace berth::host
