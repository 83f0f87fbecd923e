// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <CLI/CLI.hpp>
#include <span>
#include <string>
#include <vector>

#include "triskin/cli/command.hpp"
#include "triskin/cli/site_options.hpp"
#include "triskin/design/calibration.hpp"
#include "triskin/session/bus.hpp"
#include "triskin/wire/node_claim.hpp"

namespace triskin::cli {

/// Options that select the calibration of a command.
struct CalibrationOptions {
  /// Calibration file; empty: what the controllers keep, else what this computer keeps for them; "none": counts.
  std::string file;
};
/// Adds --calibration.
void add_calibration_options(CLI::App& app, CalibrationOptions& options);

/// The calibration of a cover on the controllers `claims` of `bus`, which are asked for theirs. One that lacks some
/// modules is left out whole, and said with `output`. Throws InputError for a file that cannot be used.
[[nodiscard]] design::SkinCalibration calibration_for(const CalibrationOptions& options, device::Bus& bus,
                                                      const robot::CoverConfig& cover,
                                                      std::span<const wire::NodeClaim> claims, const Output& output);

/// Says that a calibration is of other modules than those that its controller serves now.
[[nodiscard]] std::string note_of_other(const design::BoardCalibration& board);

/// The key "calibration" of --json: null, or `boards` (each `serial`, `revision`, `made`), `median_percent`,
/// `worst_percent`, `residual_kpa`, `max_kpa`.
[[nodiscard]] nlohmann::json calibration_keys(const design::SkinCalibration& calibration);

}  // namespace triskin::cli
