// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <CLI/CLI.hpp>
#include <optional>
#include <string>

namespace triskin::cli {

/// Returns the command `name`, or null.
[[nodiscard]] const CLI::App* find_command(const CLI::App& program, const std::string& name);

/// Answers `help`, `help COMMAND` and `help links` on standard output. Returns the exit status, or nothing if the
/// command line is none of these.
[[nodiscard]] std::optional<int> answer_help(const CLI::App& program, int argc, const char* const* argv);

}  // namespace triskin::cli
