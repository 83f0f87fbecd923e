// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/cli/command.hpp"
#include "triskin/session/stream_options.hpp"
#include "triskin/session/stream_report.hpp"

namespace triskin::cli {

/// Adds --decimation: for commands that choose every n-th sample by themselves.
void add_decimation_option(CLI::App& app, device::StreamOptions& options);

/// Adds --decimation, --every and --overload, as all commands that read the full stream have them.
void add_stream_options(CLI::App& app, device::StreamOptions& options);

/// `options` with messages of the stream to standard error.
[[nodiscard]] device::StreamOptions speaking(device::StreamOptions options);

/// Writes the keys samples, expected, lost, never_heard, every, bus_load, losses, starved and silent into `result`.
void add_stream_keys(const device::StreamReport& report, nlohmann::json& result);

/// Says what came of what was due, and adds the keys of add_stream_keys. Returns the exit status: 0 when everything
/// came, else 1.
[[nodiscard]] int conclude(const device::StreamReport& report, Output& output);

}  // namespace triskin::cli
