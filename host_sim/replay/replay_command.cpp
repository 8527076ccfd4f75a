#include <CLI/CLI.hpp>
#include <memory>
#include <thread>

#include "host_sim/replay/replay.hpp"

namespace berth::host {
namespace {

void add_inputs(CLI::App& command, ReplayOptions& o) {
  command
      .add_option("PATH", o.paths, "Images, folders of images, videos, or a camera (/dev/videoN)")
      ->required();
  command.add_option("--camera", o.camera, "Camera calibration, OpenCV YAML (default: HEC-1)");
  command.add_option("--target", o.target, "Target description, YAML (default: CT-1)");
  command.add_option("--mount", o.mount, "T_EC and T_TL, 4 x 4, OpenCV YAML (default: identity)");
  command.add_option("--truth", o.truth,
                     "truth.csv of rendered images (default: the one beside the images, if any)");
}

void add_outputs(CLI::App& command, ReplayOptions& o) {
  command.add_option("--poses", o.poses, "Write a row per image to this CSV file (-: stdout)");
  command.add_option("--markers", o.markers, "Write a row per marker to this CSV file");
  command.add_option("--tum", o.tum, "Write the valid poses as a TUM trajectory");
  command.add_option("--overlay", o.overlay,
                     "Draw what was found into this folder, a PNG per image");
  command.add_option("--report", o.report, "Write a self-contained HTML report");
  command.add_flag("--summary", o.summary, "Print a table of what was found, and how well");
}

void add_modes(CLI::App& command, ReplayOptions& o) {
  command.add_flag("--reference", o.reference,
                   "Set OpenCV's pose beside each of ours; exit 1 where they differ by more than "
                   "three sigma");
  command.add_flag("--track", o.track,
                   "Begin each search where the image before had the target (one worker)");
  command.add_flag("--on-target", o.on_target, "Run the frames through the firmware in QEMU");
  command.add_option("--firmware", o.firmware, "Firmware image for --on-target");
  command.add_option("--period-us", o.period_us, "Frame period, microseconds")
      ->capture_default_str()
      ->check(CLI::Range(1u, 1000000000u));
  command.add_option("--jobs", o.jobs, "Worker threads; the results do not depend on it")
      ->capture_default_str()
      ->check(CLI::Range(1, 256));
}

}  // namespace

void add_replay_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("replay", "Find the target in images and solve its pose");
  auto options = std::make_shared<ReplayOptions>();
  options->jobs = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  add_inputs(*command, *options);
  add_outputs(*command, *options);
  add_modes(*command, *options);
  command->callback([options, &exit_code] {
    if (options->track) options->jobs = 1;  // each image follows from the one before
    exit_code = run_replay(*options);
  });
}

}  // namespace berth::host
