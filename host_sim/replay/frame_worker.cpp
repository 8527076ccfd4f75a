#include "host_sim/replay/frame_worker.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "host_sim/replay/chain.hpp"

namespace berth::host {
namespace {

std::string size_problem(const cv::Mat& image, const Setup& setup) {
  const Camera& camera = setup.full_camera;
  const bool both_large = binning_for(image.cols, image.rows) > 1 && setup.binning > 1;
  return fmt::format(
      "its size {} x {} is not the camera's {} x {}; give the camera file of these "
      "images with --camera{}",
      image.cols, image.rows, camera.width, camera.height,
      both_large ? " (images and camera are binned alike)" : "");
}

/// Binned where the camera is; an image of another size is left as it is, for the chain to refuse.
cv::Mat fit(const cv::Mat& image, const Setup& setup, std::string& problem) {
  if (image.cols != setup.full_camera.width || image.rows != setup.full_camera.height) {
    problem = size_problem(image, setup);
    return image;
  }
  return setup.binning == 1 ? image : bin_image(image, setup.binning);
}

}  // namespace

FrameOutcome read_frame(const FrameJob& job, const Setup& setup) {
  FrameOutcome outcome;
  outcome.index = job.index;
  outcome.path = job.path;
  LoadedImage loaded = job.load();
  outcome.conversions = loaded.conversions;
  outcome.problem = loaded.error;
  if (!loaded.image.empty()) outcome.image = fit(loaded.image, setup, outcome.problem);
  outcome.record.file = job.name;
  return outcome;
}

std::filesystem::path overlay_path(const std::string& folder, const std::string& name) {
  std::string flat = name;
  std::replace(flat.begin(), flat.end(), '/', '_');
  const std::filesystem::path path = flat;
  const bool is_png = path.extension() == ".png";
  return std::filesystem::path(folder) / (is_png ? flat : flat + ".png");
}

FrameWork make_chain_worker(const Setup& setup, const ReplayOptions& options) {
  auto chain = std::make_shared<Chain>(setup.parameter_block);
  return [chain, &setup, &options](const FrameJob& job) {
    FrameOutcome outcome = read_frame(job, setup);
    const std::string name = outcome.record.file;
    outcome.record = chain->run(outcome.image, outcome.index, options.period_us);
    outcome.record.file = name;
    return outcome;
  };
}

}  // namespace berth::host
