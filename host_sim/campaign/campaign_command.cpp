#include "host_sim/campaign/campaign_command.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <thread>

#include "host_sim/campaign/campaign.hpp"

namespace berth::host {
namespace {

const std::map<std::string, CampaignSet> kSets = {{"envelope", CampaignSet::kEnvelope},
                                                  {"steep", CampaignSet::kSteep},
                                                  {"hidden", CampaignSet::kHidden},
                                                  {"empty", CampaignSet::kEmpty}};

void add_options(CLI::App& command, CampaignOptions& o) {
  command
      .add_option("--set", o.set,
                  "envelope; steep (40 to 60 deg); hidden (a marker in every frame); empty (near "
                  "misses and photographs)")
      ->transform(CLI::CheckedTransformer(kSets));
  command.add_option("--count", o.count,
                     "frames (default: envelope 20000, steep and hidden 5000, empty 10000)");
  command.add_option("--seed", o.seed, "seed of the sequence")->capture_default_str();
  command.add_option("--jobs", o.jobs, "threads; the results do not depend on it")
      ->capture_default_str()
      ->check(CLI::Range(1, 256));
  command.add_option("--out", o.out,
                     "folder for frames.csv, misses.csv and summary.txt; an interrupted campaign "
                     "goes on where it was");
  command.add_option("--photos", o.photos, "folder of photographs for the empty set")
      ->capture_default_str();
  command.add_option("--camera", o.camera, "camera file (default: HEC-1)");
  command.add_option("--target", o.target, "target file (default: CT-1)");
  auto* frames =
      command.add_option("--frames", o.frames, "only these, as pictures: 17,33")->delimiter(',');
  command.add_option("--pictures", o.pictures, "folder for the pictures of --frames")
      ->needs(frames);
  command.add_flag("--check", o.check, "exit 1 where a goal is missed");
}

}  // namespace

void add_campaign_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<CampaignOptions>();
  options->jobs = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  CLI::App* command =
      app.add_subcommand("campaign", "Count what is found over thousands of rendered frames");
  add_options(*command, *options);
  command->callback([options, &exit_code] { exit_code = run_campaign(*options); });
}

}  // namespace berth::host
