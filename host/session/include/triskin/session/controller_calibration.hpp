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

/// Calibrations in the controllers themselves (docs/calibration.md).
namespace triskin::device {

/// A calibration as a controller keeps it. Sensitivities are rounded to 16 bits of the greatest; of each module its
/// worst error and residual are kept, rounded up. A time of making that cannot be read becomes 1970. Places beyond
/// layout::kMaxModules are left out. Cost: linear.
[[nodiscard]] wire::Calibration to_wire(const design::BoardCalibration& board);
/// The calibration of the controller `serial` from what it keeps: each taxel has the error of its module's worst.
[[nodiscard]] design::BoardCalibration from_wire(const wire::Calibration& kept, const std::string& serial);

/// What the controllers of the patches of `design` on this bus keep, of those whose node address nobody shares. A
/// controller that keeps none, or whose firmware cannot, is left out. Throws as Controller.
[[nodiscard]] std::vector<design::BoardCalibration> kept_in_controllers(Bus& bus, const design::Design& design,
                                                                        std::span<const wire::NodeClaim> claims);
/// Revision of what each controller on the bus keeps, of any design, by serial number; those that keep none, share
/// their address or do not answer are left out. Throws as Bus::discover.
[[nodiscard]] std::map<std::string, int> kept_revisions(Bus& bus);
/// Writes a calibration into the controller `serial` and reads it back. False: the controller refused it, for its
/// firmware is older or its table is of another design, and keeps what it had. Throws DeviceError when it reads back
/// otherwise, and as Controller.
bool write_and_compare(Controller& controller, const wire::Calibration& wanted, const std::string& serial);
/// write_and_compare of a calibration into the controller that it is of.
bool keep_in_controller(Bus& bus, const wire::NodeClaim& claim, const design::BoardCalibration& board);
/// Deletes what a controller keeps. False: it kept none. Throws as Controller.
bool forget_in_controller(Bus& bus, const wire::NodeClaim& claim);

}  // namespace triskin::device
