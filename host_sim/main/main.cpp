// The program `berthmark`: one sub-command per job. Exit codes: 0 done, 1 a check failed, 2 wrong
// usage or unreadable input.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <string>

#include "host_sim/budget/budget_command.hpp"
#include "host_sim/campaign/campaign_command.hpp"
#include "host_sim/render/render_command.hpp"
#include "host_sim/replay/replay.hpp"

namespace {

constexpr int kWrongUsage = 2;

int run(int argc, char** argv) {
  int exit_code = 0;
  CLI::App app("Berthmark: pose of a cooperative target from the images of a hand-eye camera",
               "berthmark");
  app.require_subcommand(1);
  app.set_version_flag("--version", BERTH_VERSION);
  berth::host::add_replay_command(app, exit_code);
  berth::host::add_render_command(app, exit_code);
  berth::host::add_campaign_command(app, exit_code);
  berth::host::add_budget_command(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    std::string line = error.what();
    for (char& c : line) c = c == '\n' ? ' ' : c;
    std::fprintf(stderr, "berthmark: %s; see `berthmark --help`\n", line.c_str());
    return kWrongUsage;
  }
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "berthmark: %s\n", error.what());
    return kWrongUsage;
  }
}
