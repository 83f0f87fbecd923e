// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <CLI/CLI.hpp>
#include <string>

#include "triskin/hardware/skin_server.hpp"

namespace triskin::cli {

/// Adds --expose to a command with --listen.
void add_expose_option(CLI::App& app, bool& expose);
[[nodiscard]] hardware::Reach reach_of(bool expose);
/// Warns on standard error that anyone who reaches `link` may use it.
void warn_exposed(const std::string& link);

}  // namespace triskin::cli
