#include "host_sim/render/render_command.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <string>
#include <thread>

#include "host_sim/render/frame_writer.hpp"

namespace berth::host {
namespace {

struct RenderArguments {
  RenderJob job;
  std::string camera_path;
  std::string target_path;
};

tl::expected<void, std::string> run(RenderArguments& arguments) {
  RenderJob& job = arguments.job;
  job.camera = default_camera();
  job.target = default_target();
  if (!arguments.camera_path.empty()) {
    const auto camera = load_camera(arguments.camera_path);
    if (!camera) return tl::make_unexpected(camera.error());
    job.camera = *camera;
  }
  if (!arguments.target_path.empty()) {
    const auto target = load_target(arguments.target_path);
    if (!target) return tl::make_unexpected(target.error());
    job.target = *target;
  }
  return write_frames(job);
}

void add_options(CLI::App& command, RenderArguments& arguments) {
  RenderJob& job = arguments.job;
  command.add_option("--count", job.count, "number of frames")
      ->required()
      ->check(CLI::Range(1, 10000000));
  command.add_option("--seed", job.options.seed, "seed of the sequence")->capture_default_str();
  command.add_option("--out", job.folder, "folder for img_NNNNNN.png and truth.csv")->required();
  command.add_flag("--clean", job.options.clean,
                   "white 200, black 30, noise 2, blur 0.7, even light, plain grey");
  command.add_flag("--no-target{false}", job.options.with_target,
                   "the same scenes without the target");
  command.add_option("--distance", job.options.distance_mm, "fixed distance in mm")
      ->check(CLI::PositiveNumber);
  command.add_option("--tilt", job.options.tilt_deg, "fixed tilt in degrees")
      ->check(CLI::Range(0.0, 80.0));
  command.add_option("--camera", arguments.camera_path, "camera file (default: HEC-1)");
  command.add_option("--target", arguments.target_path, "target file (default: CT-1)");
  command.add_option("--jobs", job.threads, "threads (default: all cores)")
      ->check(CLI::Range(1, 1024));
}

}  // namespace

void add_render_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<RenderArguments>();
  arguments->job.threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  CLI::App* command = app.add_subcommand("render", "Render test scenes with ground truth");
  add_options(*command, *arguments);
  command->callback([arguments, &exit_code] {
    const auto status = run(*arguments);
    if (!status) fmt::print(stderr, "berthmark render: {}\n", status.error());
    exit_code = status ? 0 : 2;
  });
}

}  // namespace berth::host
