// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "triskin/cli/site_options.hpp"
#include "triskin/deploy/flash.hpp"

namespace triskin::cli {

/// What --save, --restore and --onto of `flash` name.
struct BackupOptions {
  std::string save, restore;      ///< They name files and are empty if not asked for.
  std::vector<std::string> onto;  ///< Each is OLD=NEW, two serial numbers.
};
/// Adds these options.
void add_backup_options(CLI::App& app, BackupOptions& options);

/// Keeps what the controllers on all buses hold in the file of --save. Throws as device::save_boards and write_output.
void save_backup(device::LiveSkin& skin, const BackupOptions& options, Output& output);

/// Writes back what the file of --restore keeps, on a site with one bus. Throws as device::read_backup and
/// device::restore_boards do, InputError for several buses. Of `flash` it takes dry_run and per_wire.
void restore_backup(device::LiveSkin& skin, const BackupOptions& options, const device::FlashOptions& flash,
                    Output& output);

}  // namespace triskin::cli
