// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace triskin::connect {

/// A device that is attached to this computer may lead to controllers.
struct AttachedDevice {
  std::string link;    ///< The text has the syntax of `--link`: can:can0, hid:SERIAL, usb:SERIAL.
  std::string remark;  ///< The remark is for a person ("CAN interface, down") and never empty.
  /// If false, the remark names the problem, for example that the interface is down or that permission is missing.
  bool usable = true;
};

/// Lists the CAN interfaces and USB boards of the computer whose file system begins at `root` ("/" for this one), as
/// /sys and /dev show them, sorted by link. Nothing is opened or sent. A missing folder counts as empty. Cost: a few
/// reads of small files.
[[nodiscard]] std::vector<AttachedDevice> attached_devices(const std::filesystem::path& root = "/");

/// Explains that nothing was opened because no link was named. Lists `devices` and says how to name one of them, or the
/// simulation.
[[nodiscard]] std::string unnamed_link_text(const std::vector<AttachedDevice>& devices);

}  // namespace triskin::connect
