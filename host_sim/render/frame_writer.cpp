#include "host_sim/render/frame_writer.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <opencv2/imgcodecs.hpp>
#include <thread>

#include "host_sim/render/truth_csv.hpp"

namespace berth::host {
namespace {

// What the threads share: the next frame, the rows so far, and the first error.
struct Progress {
  std::atomic<int> next{0};
  std::atomic<int> done{0};
  std::atomic<bool> has_failed{false};
  std::mutex mutex;
  std::string error;
  std::vector<std::string> rows;

  void fail(const std::string& what) {
    const std::lock_guard<std::mutex> lock(mutex);
    if (!has_failed.exchange(true)) error = what;
  }
};

bool write_png(const std::string& path, Image8& image) {
  // Noise hardly compresses; the fastest setting costs a few percent in size.
  const std::vector<int> settings{cv::IMWRITE_PNG_COMPRESSION, 1, cv::IMWRITE_PNG_STRATEGY,
                                  cv::IMWRITE_PNG_STRATEGY_HUFFMAN_ONLY};
  try {
    return cv::imwrite(path, cv::Mat(image.height, image.width, CV_8UC1, image.data.data()),
                       settings);
  } catch (const cv::Exception&) {
    return false;
  }
}

void show_progress(const Progress& progress, int count) {
  static const bool is_terminal = isatty(STDERR_FILENO) != 0;
  if (is_terminal) fmt::print(stderr, "\rrendered {} of {}", progress.done.load(), count);
}

void render_one(const RenderJob& job, int index, Progress& progress) {
  const Scene scene =
      sample_scene(job.options, static_cast<uint64_t>(index), job.camera, job.target);
  if (!scene.is_plate_inside) {
    progress.fail(
        fmt::format("the target does not fit into the image at {:.0f} mm; choose a "
                    "larger --distance or another camera",
                    scene.viewpoint.distance_mm));
    return;
  }
  Image8 image = render_frame(scene, job.camera, job.target);
  const std::string file = fmt::format("img_{:06}.png", index);
  const std::string path = job.folder + "/" + file;
  if (!write_png(path, image)) {
    progress.fail(path + ": cannot be written; check space and permissions");
    return;
  }
  progress.rows[static_cast<size_t>(index)] = truth_row(file, scene);
}

void work(const RenderJob& job, Progress& progress) {
  for (;;) {
    const int index = progress.next++;
    if (index >= job.count || progress.has_failed) return;
    render_one(job, index, progress);
    if (++progress.done % 8 == 0) {
      const std::lock_guard<std::mutex> lock(progress.mutex);
      show_progress(progress, job.count);
    }
  }
}

}  // namespace

tl::expected<void, std::string> write_frames(const RenderJob& job) {
  std::error_code failure;
  std::filesystem::create_directories(job.folder, failure);
  const std::string truth_path = job.folder + "/truth.csv";
  std::ofstream truth(truth_path);
  if (!truth) {
    return tl::make_unexpected(job.folder +
                               ": cannot be written; choose a folder with write permission");
  }
  Progress progress;
  progress.rows.resize(static_cast<size_t>(job.count));
  std::vector<std::thread> threads;
  for (int i = 0; i < std::min(job.threads, job.count); ++i) {
    threads.emplace_back([&] { work(job, progress); });
  }
  for (std::thread& thread : threads) thread.join();
  if (isatty(STDERR_FILENO) != 0) fmt::print(stderr, "\r{:40}\r", "");
  if (progress.has_failed) return tl::make_unexpected(progress.error);
  truth << truth_header() << '\n';
  for (const std::string& row : progress.rows) truth << row << '\n';
  truth.close();
  if (!truth) return tl::make_unexpected(truth_path + ": cannot be written; check the free space");
  return {};
}

}  // namespace berth::host
