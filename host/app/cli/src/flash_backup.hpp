// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "site_options.hpp"
#include "triskin/deploy/flash.hpp"

namespace triskin::cli {

/// The options --save, --restore and --onto of `flash` have these values.
struct BackupOptions {
  std::string save, restore;      ///< Both are names of files; empty means not requested.
  std::vector<std::string> onto;  ///< Each text is OLD=NEW, two serial numbers.
};
/// Adds --save, --restore and --onto.
void add_backup_options(CLI::App& app, BackupOptions& options);

/// Saves the data of the controllers on all buses in the file of --save. Throws as deploy::save_boards and
/// write_output.
void save_backup(skin::LiveSkin& skin, const BackupOptions& options, Output& output);

/// Restores the data in the file of --restore, on a site with one bus. Throws as deploy::read_backup and
/// deploy::restore_boards do, and InputError for several buses. Of `flash` it uses dry_run and per_wire.
void restore_backup(skin::LiveSkin& skin, const BackupOptions& options, const deploy::FlashOptions& flash,
                    Output& output);

}  // namespace triskin::cli
