#include "host_sim/replay/frame_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <opencv2/videoio.hpp>

#include "host_sim/replay/natural_order.hpp"

namespace berth::host {

namespace fs = std::filesystem;

struct FrameSource::Item {
  enum class Kind { kImage, kVideo, kCamera };
  Kind kind = Kind::kImage;
  std::string name;
  fs::path path;
};

struct FrameSource::Video {
  cv::VideoCapture capture;
  std::size_t frame = 0;
};

namespace {

constexpr std::array kImageExtensions = {".png", ".jpg", ".jpeg", ".bmp",  ".pgm",
                                         ".ppm", ".pnm", ".tif",  ".tiff", ".webp"};
constexpr std::array kVideoExtensions = {".avi", ".mp4", ".mkv",  ".mov", ".webm",
                                         ".m4v", ".mpg", ".mpeg", ".ogv", ".mjpg"};

template <std::size_t N>
bool has_extension(const fs::path& path, const std::array<const char*, N>& extensions) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(extensions.begin(), extensions.end(), extension) != extensions.end();
}

bool is_camera(const std::string& path) {
  if (path.rfind("/dev/video", 0) == 0) return true;
  return !path.empty() && path.size() <= 2 && !fs::exists(path) &&
         std::all_of(path.begin(), path.end(), [](char c) { return c >= '0' && c <= '9'; });
}

bool open_capture(cv::VideoCapture& capture, const std::string& path, bool camera) {
  try {
    const bool number = camera && path.find('/') == std::string::npos;
    return number ? capture.open(std::stoi(path)) : capture.open(path);
  } catch (const cv::Exception&) {
    return false;
  }
}

std::vector<fs::path> images_of(const fs::path& folder) {
  std::vector<fs::path> out;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (!entry.is_directory() && has_extension(entry.path(), kImageExtensions)) {
      out.push_back(entry.path());
    }
  }
  std::sort(out.begin(), out.end(), [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  return out;
}

}  // namespace

FrameSource::FrameSource() = default;
FrameSource::FrameSource(FrameSource&&) noexcept = default;
FrameSource::~FrameSource() = default;

tl::expected<FrameSource, std::string> FrameSource::open(const std::vector<std::string>& paths) {
  FrameSource source;
  for (const std::string& path : paths) {
    if (const auto added = source.add(path); !added) return tl::unexpected(added.error());
  }
  return source;
}

void FrameSource::remember_folder(const fs::path& folder) {
  const fs::path named = folder.empty() ? fs::path(".") : folder;
  if (std::find(folders_.begin(), folders_.end(), named) == folders_.end()) {
    folders_.push_back(named);
  }
}

tl::expected<void, std::string> FrameSource::add(const std::string& path) {
  const bool camera = is_camera(path);
  std::error_code error;
  if (!camera && !fs::exists(path, error)) {
    return tl::unexpected(
        fmt::format("{}: no such file or folder; check the path (a camera is /dev/videoN or its "
                    "number)",
                    path));
  }
  if (!camera && fs::is_directory(path, error)) {
    const std::vector<fs::path> images = images_of(path);
    if (images.empty()) {
      return tl::unexpected(fmt::format(
          "{}: no images in this folder; put PNG, PGM, JPEG, BMP or TIFF files there", path));
    }
    for (const fs::path& image : images) {
      items_.push_back({Item::Kind::kImage, image.filename().string(), image});
    }
    remember_folder(path);
    return {};
  }
  if (camera || has_extension(path, kVideoExtensions)) {
    cv::VideoCapture probe;
    if (!open_capture(probe, path, camera)) {
      return tl::unexpected(fmt::format(
          camera ? "{}: this camera cannot be opened; check that it exists and is free"
                 : "{}: not a video that OpenCV reads; convert it, or extract its frames as PNG",
          path));
    }
    items_.push_back({camera ? Item::Kind::kCamera : Item::Kind::kVideo, path, path});
    return {};
  }
  items_.push_back({Item::Kind::kImage, path, path});
  remember_folder(fs::path(path).parent_path());
  return {};
}

std::optional<FrameJob> FrameSource::next() {
  while (item_ < items_.size()) {
    const Item& item = items_[item_];
    if (item.kind == Item::Kind::kImage) {
      ++item_;
      return FrameJob{index_++, item.name, item.path, true, {}};
    }
    if (auto job = next_video_frame(item)) return job;
    video_.reset();
    ++item_;
  }
  return std::nullopt;
}

std::optional<FrameJob> FrameSource::next_video_frame(const Item& item) {
  if (!video_) {
    video_ = std::make_unique<Video>();
    open_capture(video_->capture, item.name, item.kind == Item::Kind::kCamera);
  }
  cv::Mat image;
  if (!video_->capture.read(image)) return std::nullopt;
  return FrameJob{index_++, fmt::format("{}#{}", item.name, video_->frame++), item.path, false,
                  image.clone()};
}

std::optional<std::size_t> FrameSource::total() const {
  const bool images_only = std::all_of(items_.begin(), items_.end(), [](const Item& item) {
    return item.kind == Item::Kind::kImage;
  });
  return images_only ? std::optional(items_.size()) : std::nullopt;
}

}  // namespace berth::host
