// `berthmark replay`: images, folders, videos or a camera through the flight code.
#pragma once

#include "host_sim/replay/replay_options.hpp"

namespace CLI {
class App;
}

namespace berth::host {

/// Exit codes: 0 done, 1 a check failed (--reference disagrees), 2 wrong usage or nothing that
/// could be read. Every error is one line on standard error.
int run_replay(const ReplayOptions& options);

/// Adds the sub-command; `exit_code` is written when it has run.
void add_replay_command(CLI::App& app, int& exit_code);

}  // namespace berth::host
