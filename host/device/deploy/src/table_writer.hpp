// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>

#include "triskin/session/controller.hpp"

namespace triskin::deploy {

/// Returns true if the table `image` is active on the controller. The bytes are read back too, because an equal CRC
/// does not suffice and reading costs little. Throws as Controller does.
[[nodiscard]] bool holds_table(session::Controller& controller, Bytes image);

/// Writes a table, activates it, reads it back and clears the fault memory, because its rows would now mean other
/// modules. `steps` (may be empty) is that of Controller::write_table. Throws DeviceError when a byte reads back
/// differently, and otherwise as Controller does.
void write_and_compare(session::Controller& controller, session::Bus& bus, Bytes image,
                       const std::function<void(double)>& steps);

}  // namespace triskin::deploy
