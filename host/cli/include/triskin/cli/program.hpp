// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "triskin/cli/command.hpp"

namespace triskin::cli {

/// Parses the command line, runs the command that it names (Registration::all()) and turns what the command throws into
/// the exit status: 0 done, 1 the answer is bad, 2 unusable input, 3 a device or link failed, 128 + n after signal n.
/// `description` heads --help. Call it once, from main.
[[nodiscard]] int run_program(const std::string& description, int argc, char** argv);

}  // namespace triskin::cli
