// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <CLI/CLI.hpp>

namespace triskin::cli {

/// What a person sets once instead of in each command: an environment variable TRISKIN_NAME for some options, and a
/// file of lines "name = value" that stands for variables which are not set. The file is
/// $XDG_CONFIG_HOME/triskin/config or ~/.config/triskin/config. Options of the command line go before both.

/// Sets the variables that only the file gives. Throws InputError with file, line and remedy for a line that is not
/// understood.
void read_settings();
/// Lets each option of the program's commands that is a setting take its variable.
void add_settings(CLI::App& program);

}  // namespace triskin::cli
