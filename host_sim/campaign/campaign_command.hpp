// `berthmark campaign`: identification and poses over thousands of frames rendered in memory.
#pragma once

#include <CLI/CLI.hpp>

namespace berth::host {

/// Adds the sub-command; when it runs, `exit_code` is set to 0, to 1 where --check finds a goal
/// missed, to 2 after one line on standard error, or to 130 after Ctrl-C.
void add_campaign_command(CLI::App& app, int& exit_code);

}  // namespace berth::host
