// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "triskin/cli/command.hpp"
#include "triskin/cli/site_options.hpp"
#include "triskin/design/calibration.hpp"
#include "triskin/skin/live_skin.hpp"

namespace triskin::cli {

/// Options that select the calibration of a command.
struct CalibrationOptions {
  /// Calibration file; empty: what the controllers keep, else what this computer keeps for them; "none": counts.
  std::string file;
};
/// Adds --calibration.
void add_calibration_options(CLI::App& app, CalibrationOptions& options);

/// Calibrates a cover of `bus`, which has discovered its controllers: they are asked for theirs. One that lacks some
/// modules is left out whole, and said with `output`. Throws InputError for a file that cannot be used.
void calibrate_cover(const CalibrationOptions& options, device::LiveBus& bus, device::LiveCover& cover,
                     const Output& output);

/// Says that a calibration is of other modules than those that its controller serves now.
[[nodiscard]] std::string note_of_other(const design::BoardCalibration& board);

/// The key "calibration" of --json: null, or `boards` (each `serial`, `revision`, `made`), `median_percent`,
/// `worst_percent`, `residual_kpa`, `max_kpa`.
[[nodiscard]] nlohmann::json calibration_keys(const design::SkinCalibration& calibration);

}  // namespace triskin::cli
