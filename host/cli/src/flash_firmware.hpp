// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "triskin/cli/command.hpp"
#include "triskin/deploy/broadcast_update.hpp"

namespace triskin::cli {

/// Options of `flash` that concern the firmware.
struct FirmwareOptions {
  std::string file;  ///< If it is empty, no firmware is written.
  bool one_by_one = false;
  device::BroadcastOptions broadcast;
};
/// Adds them to `flash`.
void add_firmware_options(CLI::App& app, FirmwareOptions& options);

/// What became of the firmware of each controller.
struct FirmwareReport {
  nlohmann::json rows = nlohmann::json::array();
  bool complete = true;  ///< Every controller runs it, or would be given it in a dry run.
};
/// Puts the package into every controller on the links, at once where they know the broadcast, and says what became of
/// each; one that a broadcast leaves to its loader and that fails there is a row with its reason. `flash` gives dry_run
/// and force. Throws InputError (a package that no controller can take), Unreachable, what broadcast_firmware() throws,
/// and one by one what update_firmware() throws: the first that fails is the last that is tried.
[[nodiscard]] FirmwareReport flash_firmware(std::span<device::Link* const> links,
                                            const device::FirmwarePackage& package, const FirmwareOptions& options,
                                            const device::FlashOptions& flash, Output& output);

}  // namespace triskin::cli
