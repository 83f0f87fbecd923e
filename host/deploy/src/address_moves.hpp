// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <vector>

#include "triskin/session/bus.hpp"

namespace triskin::device {

/// Gives controllers new node addresses, by unique id. Returns when each has said its own: two that share one would
/// both take the table of one patch, and none of them could be asked afterwards whose it is. Result: who is on the bus
/// then; with nobody in `wanted` nobody is asked, and it is empty. Throws DeviceError when one does not.
std::vector<wire::NodeClaim> assign_addresses(Bus& bus, std::map<wire::UniqueId, int> wanted);

}  // namespace triskin::device
