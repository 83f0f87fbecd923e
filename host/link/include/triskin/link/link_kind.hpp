// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string_view>

/// What the value of `--link`, or of a bus of a robot file, leads to.
namespace triskin::device {

/// Simulations in this process: all controllers on one CAN bus, or each a device on a USB hub.
inline constexpr const char *kSimulatedBus = "sim", *kSimulatedHub = "sim-usb";

/// True for the two of them.
[[nodiscard]] constexpr bool is_in_process(std::string_view link) {
  return link == kSimulatedBus || link == kSimulatedHub;
}
/// True for these, and for a simulation that another process serves (`sim:HOST:PORT`): nothing behind it is hardware.
[[nodiscard]] constexpr bool is_simulated(std::string_view link) {
  return is_in_process(link) || link.starts_with("sim:");
}
/// True for USB devices, real ones (`usb`, `hid`) or simulated ones. Else it is a CAN bus, or a served simulation.
[[nodiscard]] constexpr bool is_usb(std::string_view link) {
  return link.starts_with("usb") || link.starts_with("hid") || link == kSimulatedHub;
}

}  // namespace triskin::device
