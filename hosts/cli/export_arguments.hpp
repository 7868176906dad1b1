#pragma once
#include <CLI/CLI.hpp>

namespace posefusion {

/// Adds the sub-command `export`.
/// @param exit_code  receives that of the command, when it was given
void add_export_command(CLI::App& app, int& exit_code);

}  // namespace posefusion
