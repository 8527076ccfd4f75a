// `berthmark render`: writes test scenes as PNG files with their ground truth.
#pragma once

#include <CLI/CLI.hpp>

namespace berth::host {

/// Adds the sub-command; when it runs, `exit_code` is set to 0, or to 2 after one line on standard
/// error that says what is wrong.
void add_render_command(CLI::App& app, int& exit_code);

}  // namespace berth::host
