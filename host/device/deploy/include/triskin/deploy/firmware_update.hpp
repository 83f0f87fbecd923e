// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "triskin/base/progress.hpp"
#include "triskin/deploy/flash.hpp"
#include "triskin/layout/firmware_package.hpp"
#include "triskin/session/bus.hpp"

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
/// Reads and checks a firmware file; a DFU suffix after the package is allowed. Throws InputError naming the file and
/// what is wrong.
[[nodiscard]] FirmwarePackage read_firmware(const std::filesystem::path& file);

struct FirmwareResult {
  std::string serial;
  bool equal = false;  ///< The same image was already running, so nothing was written.
  int slot = -1;       ///< The controller now runs from this slot.
  std::size_t bytes = 0;
};

/// Writes the firmware into the free slot of one controller over CAN through its loader (docs/firmware_board.md),
/// starts it, and reads back which image runs. If it is interrupted, the old application stays and starts again. With
/// dry_run nothing is written. Throws DeviceError: no answer of application or loader, flash refused, the new
/// application was not started; Cancelled when the process was asked to end.
FirmwareResult update_firmware(session::Bus& bus, const wire::NodeClaim& controller, const FirmwarePackage& package,
                               const FlashOptions& options = {}, const ProgressSink& progress = {});

}  // namespace triskin::deploy
