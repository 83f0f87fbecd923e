// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "command.hpp"
#include "triskin/session/stream_options.hpp"
#include "triskin/session/stream_report.hpp"

namespace triskin::cli {

/// Adds --decimation, for commands that choose every n-th sample themselves.
void add_decimation_option(CLI::App& app, session::StreamOptions& options);

/// Adds --decimation, --every and --overload to a command that reads the full stream.
void add_stream_options(CLI::App& app, session::StreamOptions& options);

/// Adds a function to `options` that prints messages of the stream to standard error.
[[nodiscard]] session::StreamOptions speaking(session::StreamOptions options);

/// Writes the keys samples, expected, lost, never_heard, every, bus_load, losses, starved and silent into `result`.
void add_stream_keys(const session::StreamReport& report, nlohmann::json& result);

/// Reports which of the due samples arrived, and adds the keys of add_stream_keys. Returns the exit status: 0 when all
/// arrived, otherwise 1.
[[nodiscard]] int conclude(const session::StreamReport& report, Output& output);

}  // namespace triskin::cli
