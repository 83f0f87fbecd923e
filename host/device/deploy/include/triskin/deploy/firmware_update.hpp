// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "triskin/base/progress.hpp"
#include "triskin/layout/firmware_package.hpp"
#include "triskin/session/bus.hpp"
#include "triskin/wire/identity.hpp"

namespace triskin::deploy {

/// A firmware file (`triskin_firmware.tsf`) contains the application for both slots.
struct FirmwarePackage {
  layout::PackageHead head;
  std::vector<std::uint8_t> bytes;
  /// Returns the image for slot 0 or 1; it is valid as long as the package.
  [[nodiscard]] Bytes image(int slot) const {
    return Bytes(bytes).subspan(head.offset(slot), head.size_bytes[static_cast<std::size_t>(slot)]);
  }
};
/// Reads a firmware file; a DFU suffix after the package is allowed. Throws InputError naming the file and what is
/// wrong with it as a file: not a package, cut off, damaged. Which boards may have it says require_fit().
[[nodiscard]] FirmwarePackage read_firmware(const std::filesystem::path& file);

struct UpdateOptions {
  bool each = false;         ///< A controller that is ready starts the new image even when another one refuses it.
  bool allow_older = false;  ///< The image may replace a newer version.
  bool dry_run = false;      ///< Nothing is written; the result says what would happen.
  bool force = false;        ///< Images are written even if they are equal.
  /// Part number (F190) of the boards that are updated. Boards of another kind refuse.
  std::array<std::uint8_t, 8> hardware = wire::kPartNumber;
};

/// Checks the images of a package before any controller is asked, on every path: layout::check_image() for both slots
/// of a board with the part number `hardware`, and the version of the labels against that of the package's head. Throws
/// InputError with the reason and the remedy.
void require_fit(const FirmwarePackage& package, const std::array<std::uint8_t, 8>& hardware);

struct FirmwareResult {
  std::string serial;
  bool equal = false;  ///< The same image was already running, so nothing was written.
  int slot = -1;       ///< The controller now runs from this slot.
  std::size_t bytes = 0;
};

/// Writes the firmware into the free slot of one controller over CAN through its loader (docs/flash_layout.md),
/// starts it, and reads back which image runs. If it is interrupted, the old application stays and starts again. With
/// dry_run nothing is written. Throws InputError as require_fit(); DeviceError: the controller is of another kind or
/// runs a newer version, no answer of application or loader, flash refused, the new application was not started;
/// Cancelled when the process was asked to end.
FirmwareResult update_firmware(session::Bus& bus, const wire::NodeClaim& controller, const FirmwarePackage& package,
                               const UpdateOptions& options = {}, const ProgressSink& progress = {});

}  // namespace triskin::deploy
