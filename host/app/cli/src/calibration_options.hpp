// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "command.hpp"
#include "site_options.hpp"
#include "triskin/design/calibration.hpp"
#include "triskin/skin/live_skin.hpp"

namespace triskin::cli {

struct CalibrationOptions {
  /// An empty path means the calibration in the controllers, or else the one on this computer; "none" means counts.
  std::string file;
};
/// Adds --calibration.
void add_calibration_options(CLI::App& app, CalibrationOptions& options);

/// Calibrates a cover of `bus`, which must have discovered its controllers, because they are asked for their
/// calibrations. A calibration that lacks modules is not used at all, which `output` reports. Throws InputError for a
/// file that cannot be used.
void calibrate_cover(const CalibrationOptions& options, skin::LiveBus& bus, skin::LiveCover& cover,
                     const Output& output);

/// Reports that a calibration was made for other modules than those that its controller serves now.
[[nodiscard]] std::string note_of_other(const design::BoardCalibration& board);

/// Returns the key "calibration" of --json: null, or `boards` (each `serial`, `revision`, `made`), `median_percent`,
/// `worst_percent`, `residual_kpa`, `max_kpa`.
[[nodiscard]] nlohmann::json calibration_keys(const design::SkinCalibration& calibration);

}  // namespace triskin::cli
