#include "host_sim/budget/budget_command.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <fstream>
#include <memory>
#include <string>

#include "host_sim/budget/budget.hpp"
#include "host_sim/budget/read_image.hpp"
#include "host_sim/on_target/on_target.hpp"
#include "host_sim/replay/progress.hpp"
#include "host_sim/replay/setup.hpp"

namespace berth::host {
namespace {

constexpr int kDone = 0, kCheckFailed = 1, kWrongUsage = 2;
constexpr int kEnvelopeFrames = 24, kTrackedFrames = 6;

struct BudgetOptions {
  std::string firmware, out;
  bool check = false;
};

int refuse(const std::string& line) {
  std::fprintf(stderr, "berthmark budget: %s\n", line.c_str());
  return kWrongUsage;
}

// Every frame twice, of which the second one is counted: its search begins with the first one's
// pose.
tl::expected<InstructionCounts, std::string> count_tracked(const std::vector<double>& distances_mm,
                                                           const std::string& image) {
  ReplayOptions options;
  options.track = true;
  const auto setup = load_setup(options);
  if (!setup) return tl::unexpected(setup.error());
  std::vector<NamedFrame> twice;
  for (const double distance : distances_mm) {
    for (const NamedFrame& frame :
         frames_at(distance, kTrackedFrames, default_camera(), default_target())) {
      twice.insert(twice.end(), 2, frame);
    }
  }
  auto counts = count_instructions(twice, setup->parameter_block, image, [] {});
  if (!counts) return counts;
  std::vector<FrameCount> second;
  for (std::size_t i = 1; i < counts->frames.size(); i += 2) second.push_back(counts->frames[i]);
  counts->frames = std::move(second);
  return counts;
}

tl::expected<void, std::string> count(const std::string& image, Budget& budget) {
  const auto setup = load_setup({});
  if (!setup) return tl::unexpected(setup.error());
  const auto envelope = envelope_frames(kEnvelopeFrames, default_camera(), default_target());
  const auto adversarial = adversarial_frames(default_camera(), default_target());
  Progress progress(envelope.size() + adversarial.size());
  std::size_t sent = 0;
  const auto on_frame = [&] { progress.show(sent++, 0); };
  auto counts = count_instructions(envelope, setup->parameter_block, image, on_frame);
  if (!counts) return tl::unexpected(counts.error());
  budget.envelope = std::move(*counts);
  counts = count_instructions(adversarial, setup->parameter_block, image, on_frame);
  if (!counts) return tl::unexpected(counts.error());
  budget.adversarial = std::move(*counts);
  counts = count_tracked({300}, image);
  if (!counts) return tl::unexpected(counts.error());
  budget.tracked_near = std::move(*counts);
  counts = count_tracked({800, 1100, 1500}, image);
  if (!counts) return tl::unexpected(counts.error());
  budget.tracked_far = std::move(*counts);
  return {};
}

int check(const Budget& budget) {
  int exit_code = kDone;
  const auto complain = [&](const std::string& line) {
    std::fprintf(stderr, "berthmark budget: %s\n", line.c_str());
    exit_code = kCheckFailed;
  };
  for (const Limit& l : limits_of(budget)) {
    if (l.used > l.limit) {
      complain(fmt::format("{}: {:.2f} {}, the limit is {:g}", l.what, l.used, l.unit, l.limit));
    }
  }
  for (const InstructionCounts* counts : {&budget.envelope, &budget.adversarial}) {
    if (counts->stack_peak_bytes <= static_cast<std::uint32_t>(budget.application.bytes)) continue;
    complain("the painted stack goes deeper than the call graph: a call is missing from it");
  }
  return exit_code;
}

int run_budget(const BudgetOptions& options) {
  const std::string image = options.firmware.empty() ? default_image_path() : options.firmware;
  Budget budget;
  if (const auto read = read_image(image, budget); !read) return refuse(read.error());
  if (const auto counted = count(image, budget); !counted) return refuse(counted.error());
  const std::string text = budget_text(budget);
  if (options.out.empty()) {
    std::fputs(text.c_str(), stdout);
  } else {
    std::ofstream file(options.out);
    if (!(file << text).flush()) return refuse(options.out + ": cannot be written");
  }
  return options.check ? check(budget) : kDone;
}

}  // namespace

void add_budget_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<BudgetOptions>();
  CLI::App* command = app.add_subcommand(
      "budget", "Memory, stack and instructions of the firmware against the reference parts");
  command->add_option("--firmware", options->firmware,
                      "firmware image; its map and the compiler's .ci files lie beside it");
  command->add_option("--out", options->out, "write the report to this file (Markdown)");
  command->add_flag("--check", options->check, "exit 1 where a limit is exceeded");
  command->callback([options, &exit_code] { exit_code = run_budget(*options); });
}

}  // namespace berth::host
