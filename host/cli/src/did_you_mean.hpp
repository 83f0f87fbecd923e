// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <CLI/CLI.hpp>
#include <string>

namespace triskin::cli {

/// For a word of the command line that is no command or option of `program`, the nearest one: "did you mean record?".
/// Empty when all words are known or nothing is near.
[[nodiscard]] std::string did_you_mean(const CLI::App& program, int argc, const char* const* argv);

}  // namespace triskin::cli
