// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>

#include "triskin/session/controller.hpp"

namespace triskin::device {

/// Writes a table, activates it, reads it back and deletes the fault memory, whose rows would mean other modules.
/// `steps` (may be empty): Controller::write_table. Throws DeviceError when a byte reads back differently, as
/// Controller does otherwise.
void write_and_compare(Controller& controller, Bus& bus, Bytes image, const std::function<void(double)>& steps);

}  // namespace triskin::device
