// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "command.hpp"

namespace triskin::cli {

/// Parses the command line, runs the command that it names (Registration::all()) and turns exceptions into the exit
/// status: 0 success, 1 a bad answer, 2 unusable input, 3 a device or link failed, 128 + n after signal n.
/// `description` is the head of --help. Call it once, from main.
[[nodiscard]] int run_program(const std::string& description, int argc, char** argv);

}  // namespace triskin::cli
