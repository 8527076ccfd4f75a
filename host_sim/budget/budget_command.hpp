// `berthmark budget`: memory, stack and instructions of the firmware image against the parts.
#pragma once

#include <CLI/CLI.hpp>

namespace berth::host {

/// Adds the sub-command; when it runs, `exit_code` is set to 0, to 1 where --check finds a limit
/// exceeded, or to 2 after one line on standard error.
void add_budget_command(CLI::App& app, int& exit_code);

}  // namespace berth::host
