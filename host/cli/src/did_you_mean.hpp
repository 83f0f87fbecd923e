// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <CLI/CLI.hpp>
#include <string>

namespace triskin::cli {

/// Suggests the nearest command or option of `program` for an unknown word of the command line: "did you mean record?".
/// Empty when all words are known or none is similar.
[[nodiscard]] std::string did_you_mean(const CLI::App& program, int argc, const char* const* argv);

}  // namespace triskin::cli
