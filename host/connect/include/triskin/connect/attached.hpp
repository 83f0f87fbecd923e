// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace triskin::device {

/// Device of this computer that may lead to controllers.
struct AttachedDevice {
  std::string link;    ///< It has the syntax of `--link`: can:can0, hid:SERIAL, usb:SERIAL.
  std::string remark;  ///< It is text for a person ("CAN interface, down") and never empty.
  bool usable = true;  ///< If false, the remark says what is wrong, as that it is down or lacks a permission.
};

/// The CAN interfaces and the USB boards of the computer whose file system begins at `root` ("/" for this one), as
/// /sys and /dev show them; sorted by link. Nothing is opened or sent. A folder that is not there holds nothing.
/// Cost: some reads of small files.
[[nodiscard]] std::vector<AttachedDevice> attached_devices(const std::filesystem::path& root = "/");

/// Why nothing was opened: no link was named. Lists `devices` and says how to name one of them, or the simulation.
[[nodiscard]] std::string unnamed_link_text(const std::vector<AttachedDevice>& devices);

}  // namespace triskin::device
