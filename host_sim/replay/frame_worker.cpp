#include "host_sim/replay/frame_worker.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "host_sim/replay/chain.hpp"
#include "host_sim/replay/outputs.hpp"
#include "host_sim/report/overlay.hpp"

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

void write_overlay(const FrameOutcome& outcome, const Trace* trace, const Setup& setup,
                   const ReplayOptions& options) {
  const cv::Mat picture =
      draw_overlay(outcome.image, outcome.record, trace, {setup.camera, setup.target});
  // Folders may hold files of the same name; then the path tells them apart.
  const bool by_path =
      options.paths.size() > 1 && outcome.record.file.find('#') == std::string::npos;
  const std::string path =
      overlay_path(options.overlay, by_path ? outcome.path.string() : outcome.record.file).string();
  bool written = false;
  try {
    written = cv::imwrite(path, picture);
  } catch (const cv::Exception&) {
    // The same complaint as for a plain failure, below.
  }
  if (!written) throw std::runtime_error(unwritable(path));
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

void finish_frame(FrameOutcome& outcome, const Trace* trace, const Setup& setup,
                  const ReplayOptions& options) {
  if (options.reference && outcome.problem.empty()) {
    outcome.reference = compare_with_reference(
        outcome.record, reference_pose(outcome.image, setup.camera, setup.target));
  }
  if (!options.overlay.empty()) write_overlay(outcome, trace, setup, options);
}

FrameWork make_chain_worker(const Setup& setup, const ReplayOptions& options) {
  auto chain = std::make_shared<Chain>(setup.parameter_block);
  return [chain, &setup, &options](const FrameJob& job) {
    FrameOutcome outcome = read_frame(job, setup);
    const std::string name = outcome.record.file;
    outcome.record = chain->run(outcome.image, outcome.index, options.period_us);
    outcome.record.file = name;
    const Trace trace = options.overlay.empty() ? Trace{} : read_trace(chain->workspace());
    finish_frame(outcome, &trace, setup, options);
    return outcome;
  };
}

}  // namespace berth::host
