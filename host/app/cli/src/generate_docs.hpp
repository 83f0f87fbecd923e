// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <CLI/CLI.hpp>
#include <optional>
#include <string>

namespace triskin::cli {

/// Answers the hidden command `generate-docs`, which is used to build packages: `man [COMMAND]` prints a manual page,
/// `bash` a completion. Returns the exit status, or nothing if the command line has another command.
[[nodiscard]] std::optional<int> answer_generate_docs(const CLI::App& program, int argc, const char* const* argv);

/// Formats the manual page (section 1, troff) of a command, or of the program itself.
[[nodiscard]] std::string manual_page(const CLI::App& program, const CLI::App& command);

/// Formats the completion of commands, options and files for bash.
[[nodiscard]] std::string bash_completion(const CLI::App& program);

}  // namespace triskin::cli
