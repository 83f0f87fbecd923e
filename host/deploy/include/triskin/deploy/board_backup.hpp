// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "triskin/design/calibration.hpp"
#include "triskin/session/bus.hpp"
#include "triskin/session/scheduler.hpp"

namespace triskin::device {

/// What a controller holds, as far as its protocol reads it (docs/backup.md says what of it can be written back).
struct BoardBackup {
  /// A fault that the controller remembers, with what was noted when it occurred first.
  struct Fault {
    std::uint32_t code = 0;           ///< It is a diagnostic trouble code.
    std::uint8_t status = 0;          ///< Its bits are those of wire::fault_status.
    std::vector<std::uint8_t> noted;  ///< It is a wire::FreezeFrame, or empty when nothing was noted.
  };
  std::string serial;               ///< It is the controller's unique id.
  int node_address = 0;             ///< It ranges from 1 to 126.
  std::vector<std::uint8_t> table;  ///< It is the table as it is flashed, and empty when there is none.
  std::map<std::uint16_t, std::vector<std::uint8_t>>
      values;  ///< Every identifier in wire::kIdentifiers that the board returned has its value here.
  std::vector<Fault> faults;
  /// Calibration that this computer keeps for the controller (CalibrationStore); none: it keeps none, or the file is
  /// of an older release.
  std::optional<design::BoardCalibration> calibration{};
};

/// Reads every controller on the link whose address nobody shares; nothing is written. Controllers without a table that
/// share theirs hold nothing and are said. Throws DeviceError when nobody answers or one with a table shares its
/// address (it cannot be asked, so it could not be kept), as Bus::request does.
[[nodiscard]] std::vector<BoardBackup> save_boards(Bus& bus, const std::function<void(const std::string&)>& say);

/// Text of a file that keeps boards. Two checks stand in it: a CRC over all boards, and that of each table.
[[nodiscard]] std::string backup_text(std::span<const BoardBackup> boards);
/// Reads such a file. Throws InputError naming file, place and remedy: truncated, damaged, another format or version, a
/// table that is none, a board that stands twice.
[[nodiscard]] std::vector<BoardBackup> read_backup(const std::filesystem::path& path);

struct RestoreOptions {
  bool dry_run = false;  ///< Everything is checked and nothing written.
  /// What the controller with the first serial number held goes into the second one.
  std::map<std::string, std::string> onto;
  int per_wire = kTasksPerWire;  ///< So many controllers, at least 1, are served at once on one wire.
};
/// Result of restoring one board of the file.
struct RestoredBoard {
  std::string serial;     ///< The controller with this serial number holds the data now.
  std::string kept_from;  ///< The data was read from the controller with this serial number.
  int node_address = 0;
  /// Size of the table; 0: the file has no table for it, and the controller keeps the one it holds.
  std::size_t bytes = 0;
  bool equal = false;  ///< The table and the address were the same already.
  bool written = false;
  /// The calibration that was kept in the board of the file is in this one again; false: there was none, it was there
  /// already, or a dry run.
  bool calibrated = false;
  /// The controller did not take it: its firmware is older.
  bool calibration_refused = false;
};

/// Writes node address and table of every board of a file back into the controller with its serial number, or the one
/// that `options.onto` names, and reads the table back; then the calibration that the board kept with its table.
/// Everything is checked before the first byte is written: the controllers answer, are of the kind (part number, layout
/// version) that was kept, and no two get one address, nor that of a controller that is not in the file. Each
/// controller has its old table or its new one, whole. Throws InputError for a file that does not fit, DeviceError when
/// a controller does not answer or refuses; both say what was written.
std::vector<RestoredBoard> restore_boards(Bus& bus, std::span<const BoardBackup> boards, const RestoreOptions& options);

}  // namespace triskin::device
