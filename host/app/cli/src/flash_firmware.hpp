// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <string>

#include "command.hpp"
#include "triskin/deploy/broadcast_update.hpp"
#include "triskin/deploy/flash.hpp"

namespace triskin::cli {

struct FirmwareOptions {
  std::string file;  ///< An empty name means that no firmware is written.
  bool one_by_one = false;
  deploy::UpdateOptions update;
};
/// Adds these options to `flash`.
void add_firmware_options(CLI::App& app, FirmwareOptions& options);

/// The report has the result of the firmware update for each controller.
struct FirmwareReport {
  nlohmann::json rows = nlohmann::json::array();
  bool complete = true;  ///< True means that every controller runs the firmware, or would get it without the dry run.
};
/// Updates every controller on the links, at once if they know the broadcast, and reports the result for each. One in
/// `expected` that does not answer gets a row too, and the report is not complete. If a broadcast leaves a controller
/// to its loader and that fails, its row has the reason. `flash` gives dry_run and force. Throws InputError (a package
/// that no controller can use), Unreachable, the exceptions of broadcast_firmware(), and those of update_firmware(),
/// which is called one by one until the first failure.
[[nodiscard]] FirmwareReport flash_firmware(std::span<link::Link* const> links,
                                            const std::set<wire::UniqueId>& expected,
                                            const deploy::FirmwarePackage& package, const FirmwareOptions& options,
                                            const deploy::FlashOptions& flash, Output& output);

}  // namespace triskin::cli
