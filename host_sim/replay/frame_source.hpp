// Where the frames of a replay come from: image files, folders, videos, a camera.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "host_sim/replay/image_input.hpp"

namespace berth::host {

/// A frame to be processed. Image files are still to be read, which is the worker's business.
struct FrameJob {
  std::size_t index = 0;       // position in the whole replay
  std::string name;            // the `file` column
  std::filesystem::path path;  // where it lies
  bool is_file = true;         // false: `image` holds a video's frame
  cv::Mat image;

  LoadedImage load() const { return is_file ? load_image(path) : to_gray_8(image); }
};

/// The frames of all paths in order. `next` hands them out one by one; not safe for threads.
class FrameSource {
 public:
  /// Refuses (with one line that names the path and the cure) what does not exist, a folder
  /// without images, a video or camera that cannot be opened. Folders are in natural order.
  static tl::expected<FrameSource, std::string> open(const std::vector<std::string>& paths);

  FrameSource(FrameSource&&) noexcept;
  ~FrameSource();

  std::optional<FrameJob> next();
  /// Number of frames where it is known beforehand (no video, no camera).
  std::optional<std::size_t> total() const;
  /// The folders named on the command line, or that the named files lie in; without duplicates.
  const std::vector<std::filesystem::path>& folders() const { return folders_; }

 private:
  struct Item;
  FrameSource();
  tl::expected<void, std::string> add(const std::string& path);
  void remember_folder(const std::filesystem::path& folder);
  std::optional<FrameJob> next_video_frame(const Item& item);

  std::vector<Item> items_;
  std::vector<std::filesystem::path> folders_;
  std::size_t item_ = 0;
  std::size_t index_ = 0;
  struct Video;
  std::unique_ptr<Video> video_;
};

}  // namespace berth::host
