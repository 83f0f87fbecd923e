// SPDX-License-Identifier: GPL-3.0-or-later
#include "flash_backup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "triskin/base/counted.hpp"
#include "triskin/base/files.hpp"
#include "triskin/deploy/board_backup.hpp"
#include "triskin/deploy/board_file.hpp"
#include "triskin/skin/calibrate.hpp"

namespace triskin::cli {
namespace {

std::map<std::string, std::string> read_onto(const std::vector<std::string>& texts) {
  std::map<std::string, std::string> onto;
  for (const std::string& text : texts) {
    const std::size_t at = text.find('=');
    const std::string from = deploy::normal_serial(text.substr(0, at)),
                      to = at == std::string::npos ? "" : deploy::normal_serial(text.substr(at + 1));
    if (from.empty() || to.empty())
      throw InputError(
          fmt::format("--onto \"{}\": give OLD=NEW, two serial numbers as triskin discover shows them", text));
    if (!onto.emplace(from, to).second) throw InputError(fmt::format("--onto: controller {} is named twice", from));
  }
  return onto;
}

std::string outcome_of(const deploy::RestoredBoard& b, bool dry_run) {
  if (b.bytes == 0) return "had no table; left as it is";
  if (b.equal) return "equal, skipped";
  if (dry_run) return fmt::format("would write {} for node address {}", counted(b.bytes, "byte"), b.node_address);
  if (!b.written) return fmt::format("node address {} again", b.node_address);
  return fmt::format("{} written and read back, node address {}", counted(b.bytes, "byte"), b.node_address);
}

// A calibration belongs to the modules, which stay in place when a new board replaces the old one.
void restore_calibrations(std::span<const deploy::BoardBackup> boards, std::span<const deploy::RestoredBoard> restored,
                          const Output& output) {
  const skin::CalibrationStore store;
  for (const deploy::BoardBackup& b : boards) {
    const auto now = std::ranges::find(restored, b.serial, &deploy::RestoredBoard::kept_from);
    if (!b.calibration || now == restored.end()) continue;
    design::BoardCalibration calibration = *b.calibration;
    calibration.serial = now->serial;
    store.write(calibration);
    output.say(
        fmt::format("controller {}  revision {} of its calibration is kept again", now->serial, calibration.revision));
  }
}

}  // namespace

void add_backup_options(CLI::App& app, BackupOptions& options) {
  app.add_option("--save", options.save, "first save what the controllers hold to this file");
  app.add_option("--restore", options.restore,
                 "write back what --save saved, instead of the design's tables (docs/deploy.md)");
  app.add_option("--onto", options.onto, "with --restore: OLD=NEW, serial numbers: NEW replaces OLD; may be repeated");
}

void save_backup(skin::LiveSkin& skin, const BackupOptions& options, Output& output) {
  std::vector<std::vector<deploy::BoardBackup>> buses(skin.buses().size());
  skin.on_each_bus([&](skin::LiveBus& bus) { buses[bus.index()] = deploy::save_boards(bus.bus(), say_aside); });
  std::vector<deploy::BoardBackup> all;
  for (auto& bus : buses) std::ranges::move(bus, std::back_inserter(all));
  const skin::CalibrationStore calibrations;
  for (deploy::BoardBackup& b : all) b.calibration = calibrations.read(b.serial);
  write_output(options.save, deploy::backup_text(all));
  output.say(fmt::format("what {} {} -> {}", counted(all.size(), "controller"), agreeing(all.size(), "holds", "hold"),
                         options.save));
}

namespace {

nlohmann::json report_restored(const deploy::RestoredBoard& b, bool dry_run, const Output& output) {
  output.say(fmt::format("controller {}  {}", b.serial, outcome_of(b, dry_run)));
  if (b.calibrated) output.say(fmt::format("controller {}  holds its calibration again", b.serial));
  if (b.calibration_refused)
    output.say(
        fmt::format("controller {}  did not accept its calibration: its firmware is too old; run triskin flash "
                    "--firmware, then restore again",
                    b.serial));
  return {{"serial", b.serial}, {"kept_from", b.kept_from}, {"node_address", b.node_address}, {"bytes", b.bytes},
          {"equal", b.equal},   {"written", b.written},     {"calibrated", b.calibrated}};
}

}  // namespace

void restore_backup(skin::LiveSkin& skin, const BackupOptions& options, const deploy::FlashOptions& flash,
                    Output& output) {
  if (skin.buses().size() != 1)
    throw InputError("--restore writes on one bus: give a design and --link, or a cover on one bus with --cover");
  const auto boards = deploy::read_backup(options.restore);
  session::Bus& bus = skin.buses().front()->bus();
  const bool dry_run = flash.dry_run;
  const auto restored = deploy::restore_boards(bus, boards, {dry_run, read_onto(options.onto), flash.per_wire});
  if (!dry_run) restore_calibrations(boards, restored, output);
  nlohmann::json rows = nlohmann::json::array();
  std::size_t bytes = 0;
  for (const deploy::RestoredBoard& b : restored) {
    rows.push_back(report_restored(b, dry_run, output));
    if (b.written) bytes += b.bytes;
  }
  output.result = {{"controllers", restored.size()}, {"bytes", bytes}, {"dry_run", dry_run}, {"restored", rows}};
}

}  // namespace triskin::cli
