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

namespace triskin::deploy {

/// The protocol of a controller lets us read these data (docs/deploy.md says which of it can be written back).
struct BoardBackup {
  /// The controller remembers a fault with the data recorded when it first occurred.
  struct Fault {
    std::uint32_t code = 0;           ///< The number is a diagnostic trouble code.
    std::uint8_t status = 0;          ///< The bits are those of wire::fault_status.
    std::vector<std::uint8_t> noted;  ///< The bytes are a wire::FreezeFrame; empty means that nothing was recorded.
  };
  std::string serial;               ///< The serial number is the controller's unique id.
  int node_address = 0;             ///< Valid values are 1 to 126.
  std::vector<std::uint8_t> table;  ///< The bytes are the table as it is flashed; empty means that there is none.
  std::map<std::uint16_t, std::vector<std::uint8_t>>
      values;  ///< The map has the value of each identifier in wire::kIdentifiers that the board returned.
  std::vector<Fault> faults;
  /// The calibration comes from this computer (CalibrationStore); it is empty if the store has none, or if the file is
  /// of an older release.
  std::optional<design::BoardCalibration> calibration{};
};

/// Reads every controller on the link whose address is not shared, without writing anything. Controllers without a
/// table that share their address hold nothing and are only reported. Throws DeviceError when no controller answers, or
/// when one with a table shares its address and so cannot be read; and as Bus::request does.
[[nodiscard]] std::vector<BoardBackup> save_boards(session::Bus& bus,
                                                   const std::function<void(const std::string&)>& say);

/// Formats a backup file. It contains a CRC over all boards and the CRC of each table.
[[nodiscard]] std::string backup_text(std::span<const BoardBackup> boards);
/// Reads a backup file. Throws InputError naming file, place and remedy: truncated, damaged, another format or version,
/// an invalid table, a board that occurs twice.
[[nodiscard]] std::vector<BoardBackup> read_backup(const std::filesystem::path& path);

struct RestoreOptions {
  bool dry_run = false;  ///< Everything is checked, but nothing is written.
  /// The data of the controller with the first serial number are written to the second one.
  std::map<std::string, std::string> onto;
  int per_wire =
      session::kTasksPerWire;  ///< This many controllers, at least 1, are served at the same time on one wire.
};
struct RestoredBoard {
  std::string serial;     ///< The controller with this serial number now has the data.
  std::string kept_from;  ///< The data were read from the controller with this serial number.
  int node_address = 0;
  /// A size of 0 means that the file has no table for the board, which then keeps its own.
  std::size_t bytes = 0;
  bool equal = false;  ///< The table and the address were already the same.
  bool written = false;
  /// True means that the board's calibration was written to this controller; false: there was none, it was already
  /// there, or a dry run.
  bool calibrated = false;
  /// The controller did not accept the calibration, because its firmware is older.
  bool calibration_refused = false;
};

/// Writes node address and table of every board of a file back into the controller with its serial number, or into the
/// one that `options.onto` names, and reads the table back; then writes the calibration that the board stored with its
/// table. Before the first byte is written, it checks that the controllers answer, that they are of the same kind (part
/// number, layout version) as the saved ones, and that no two get the same address or that of a controller outside the
/// file. Each controller has either its complete old table or its complete new one. Throws InputError for a file that
/// does not fit, and DeviceError when a controller does not answer or refuses; both say what was written.
std::vector<RestoredBoard> restore_boards(session::Bus& bus, std::span<const BoardBackup> boards,
                                          const RestoreOptions& options);

}  // namespace triskin::deploy
