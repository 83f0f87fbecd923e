// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string_view>

/// Classifies the value of `--link`, or of a bus of a robot file.
namespace triskin::link {

/// These links simulate in this process: all controllers on one CAN bus, or each as a device on a USB hub.
inline constexpr const char *kSimulatedBus = "sim", *kSimulatedHub = "sim-usb";

/// Returns true for the simulations in this process.
[[nodiscard]] constexpr bool is_in_process(std::string_view link) {
  return link == kSimulatedBus || link == kSimulatedHub;
}
/// Returns true for simulations in this process, and for one that another process serves (`sim:HOST:PORT`); none of
/// them leads to hardware.
[[nodiscard]] constexpr bool is_simulated(std::string_view link) {
  return is_in_process(link) || link.starts_with("sim:");
}
/// Returns true for USB devices, either real ones (`usb`, `hid`) or simulated ones. Other links are a CAN bus, or a
/// served simulation.
[[nodiscard]] constexpr bool is_usb(std::string_view link) {
  return link.starts_with("usb") || link.starts_with("hid") || link == kSimulatedHub;
}

}  // namespace triskin::link
