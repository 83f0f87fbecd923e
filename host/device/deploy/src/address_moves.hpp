// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <vector>

#include "triskin/session/bus.hpp"

namespace triskin::deploy {

/// Gives controllers new node addresses, by unique id. Returns only when each has reported its new address, because two
/// that share one would both accept the table of one patch and could not be told apart afterwards. Returns the
/// controllers that are then on the bus, all that the bus knows; if `wanted` is empty, nobody is asked and the result
/// is empty. Throws DeviceError when a controller does not report its address, or one that answered before is silent.
std::vector<wire::NodeClaim> assign_addresses(session::Bus& bus, std::map<wire::UniqueId, int> wanted);

}  // namespace triskin::deploy
