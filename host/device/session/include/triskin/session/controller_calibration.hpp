// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <span>
#include <string>
#include <vector>

#include "triskin/design/calibration.hpp"
#include "triskin/session/bus.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/wire/calibration.hpp"
#include "triskin/wire/node_claim.hpp"

/// Calibrations that controllers store themselves (docs/calibration.md).
namespace triskin::session {

/// Converts a calibration to the form that a controller stores. Sensitivities are rounded to 16 bits of the greatest;
/// each module keeps its worst error and residual, rounded up. A date that cannot be parsed becomes 1970. Places beyond
/// layout::kMaxModules are left out. Cost: linear.
[[nodiscard]] wire::Calibration to_wire(const design::BoardCalibration& board);
/// Converts what the controller `serial` stores; each taxel gets the error of the worst one of its module.
[[nodiscard]] design::BoardCalibration from_wire(const wire::Calibration& kept, const std::string& serial);

/// Reads what the controllers of the patches of `design` on this bus store, if their node address is not shared.
/// Controllers that store nothing, or whose firmware cannot, are left out. Throws as Controller.
[[nodiscard]] std::vector<design::BoardCalibration> kept_in_controllers(Bus& bus, const design::Design& design,
                                                                        std::span<const wire::NodeClaim> claims);
/// Returns the revision that each controller on the bus stores, of any design, by serial number. Controllers that store
/// none, share their address or do not answer are left out. Throws as Bus::discover.
[[nodiscard]] std::map<std::string, int> kept_revisions(Bus& bus);
/// Writes a calibration into the controller `serial` and reads it back. Returns false if the controller refused it,
/// because its firmware is older or its table is of another design; it then keeps the old calibration. Throws
/// DeviceError when it reads back differently, and as Controller.
bool write_and_compare(Controller& controller, const wire::Calibration& wanted, const std::string& serial);
/// Stores a calibration in the controller that it belongs to, with write_and_compare.
bool keep_in_controller(Bus& bus, const wire::NodeClaim& claim, const design::BoardCalibration& board);
/// Deletes the calibration in a controller. Returns false if it stored none. Throws as Controller.
bool forget_in_controller(Bus& bus, const wire::NodeClaim& claim);

}  // namespace triskin::session
