// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <CLI/CLI.hpp>
#include <string>

namespace triskin::cli {

/// Suggests the nearest command or option of `program` for an unknown word of the command line, "did you mean record?",
/// or, if that is what is wrong (`is_unknown`), names the commands that know an option which this one does not. Empty
/// when all words are known, or nobody knows it.
[[nodiscard]] std::string did_you_mean(const CLI::App& program, int argc, const char* const* argv, bool is_unknown);

}  // namespace triskin::cli
